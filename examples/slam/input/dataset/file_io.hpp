// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <stdexcept>
#include <string>

namespace hmcdyn::slam {

/// The error for bad data in a file: "FILE:LINE: message".
std::runtime_error errorAt(const std::filesystem::path& file, std::size_t line,
                           const std::string& message);

/// The bytes of a file.
/// @throws std::runtime_error that names the file where it is missing, a folder or unreadable.
std::string readFile(const std::filesystem::path& file);

/// A field as a finite number, whatever the locale.
/// @param what the field's name in the message, such as "time stamp".
/// @throws std::runtime_error with file and line where the field is anything else.
double parseFinite(const std::string& field, const std::string& what,
                   const std::filesystem::path& file, std::size_t line);

}  // namespace hmcdyn::slam

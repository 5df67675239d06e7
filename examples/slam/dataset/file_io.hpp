// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace hmcdyn::slam {

/// The error for bad data in a file: "FILE:LINE: message".
std::runtime_error errorAt(const std::filesystem::path& file, std::size_t line,
                           const std::string& message);

/// The bytes of a file.
/// @throws std::runtime_error that names the file where it is missing, a folder or unreadable.
std::string readFile(const std::filesystem::path& file);

/// A line of a table in a text file.
struct TextRow {
  std::size_t line = 0;             ///< Line in the file, from 1.
  std::vector<std::string> fields;  ///< What white space separates; at least one.
};

/// The rows of a text file, without blank lines and those that start with '#'.
/// @throws std::runtime_error as readFile().
std::vector<TextRow> readTextRows(const std::filesystem::path& file);

/// A field as a finite number, whatever the locale.
/// @param what the field's name in the message, such as "time stamp".
/// @throws std::runtime_error with file and line where the field is anything else.
double parseFinite(const std::string& field, const std::string& what,
                   const std::filesystem::path& file, std::size_t line);

}  // namespace hmcdyn::slam

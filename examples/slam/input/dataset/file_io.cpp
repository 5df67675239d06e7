// SPDX-License-Identifier: BSD-3-Clause
#include "slam/input/dataset/file_io.hpp"

#include "support/text_table.hpp"

namespace hmcdyn::slam {

std::runtime_error errorAt(const std::filesystem::path& file, std::size_t line,
                           const std::string& message) {
  return support::errorAt(file.string(), line, message);
}

std::string readFile(const std::filesystem::path& file) { return support::readBytes(file); }

double parseFinite(const std::string& field, const std::string& what,
                   const std::filesystem::path& file, std::size_t line) {
  return support::parseFinite(field, what, file.string(), line);
}

}  // namespace hmcdyn::slam

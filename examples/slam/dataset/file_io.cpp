// SPDX-License-Identifier: BSD-3-Clause
#include "slam/dataset/file_io.hpp"

#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <sstream>
#include <system_error>

#include <fmt/format.h>

namespace hmcdyn::slam {

std::runtime_error errorAt(const std::filesystem::path& file, std::size_t line,
                           const std::string& message) {
  return std::runtime_error(fmt::format("{}:{}: {}", file.string(), line, message));
}

std::string readFile(const std::filesystem::path& file) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) {
    throw std::runtime_error(fmt::format("{}: no such file", file.string()));
  }
  if (!std::filesystem::is_regular_file(status)) {
    throw std::runtime_error(fmt::format("{}: is not a regular file", file.string()));
  }
  std::string bytes(std::filesystem::file_size(file), '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!stream) {
    throw std::runtime_error(fmt::format("{}: cannot be read", file.string()));
  }
  return bytes;
}

std::vector<TextRow> readTextRows(const std::filesystem::path& file) {
  std::istringstream text(readFile(file));
  std::vector<TextRow> rows;
  std::string line;
  for (std::size_t number = 1; std::getline(text, line); ++number) {
    std::istringstream words(line);  // '\r' counts as white space: Windows' line ends are fine
    TextRow row{number, {std::istream_iterator<std::string>(words), {}}};
    if (!row.fields.empty() && row.fields.front().front() != '#') {
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

double parseFinite(const std::string& field, const std::string& what,
                   const std::filesystem::path& file, std::size_t line) {
  double value = 0.0;
  const char* const end = field.data() + field.size();
  const std::from_chars_result parsed = std::from_chars(field.data(), end, value);
  if (parsed.ec != std::errc{} || parsed.ptr != end || !std::isfinite(value)) {
    constexpr std::size_t kQuoted = 40;  // a binary file has long "words"
    throw errorAt(
        file, line,
        fmt::format("{} is '{}'; expected a finite number", what, field.substr(0, kQuoted)));
  }
  return value;
}

}  // namespace hmcdyn::slam

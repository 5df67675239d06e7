// SPDX-License-Identifier: BSD-3-Clause
// Tables in text files as people have them: what is unambiguous is read, the rest named.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace hmcdyn::support {

/// The error for bad data in a file: "FILE:LINE: message".
std::runtime_error errorAt(const std::string& file, std::size_t line, const std::string& message);

/// The bytes of a file.
/// @throws std::runtime_error that names the file where it is missing, a folder or unreadable.
std::string readBytes(const std::filesystem::path& file);

/// The UTF-8 text that bytes hold: in UTF-8 with or without its mark, or in UTF-16 of either order,
/// as Windows' editors save it. Blanks of other widths become blanks, the typographic minus a
/// minus, and line ends '\n'.
/// @throws std::runtime_error "FILE: ..." where the bytes are no text, with what they are if their
/// first ones say so.
std::string toText(const std::string& bytes, const std::string& file);

/// A line of a table.
struct TextRow {
  std::size_t line = 0;             ///< Line in the file, from 1.
  std::vector<std::string> fields;  ///< At least one.
};

/// A table, and what was assumed to read it.
struct TextTable {
  std::vector<TextRow> rows;
  std::vector<std::string> notes;  ///< "FILE: ...", a sentence each.
};

/// Splits text into the rows of a table. Left out are blank lines, those that start with '#', '%'
/// or "//", what stands behind a blank and '#' in a row, and a line of column names above the first
/// row. Fields are separated by blanks, tabs, commas or semicolons; where commas are the numbers'
/// decimal points, they become points, which is noted: if blanks alone give a number of fields that
/// fits.
/// @param fits which numbers of fields a row may have.
TextTable parseTable(std::string_view text, const std::string& file,
                     const std::function<bool(std::size_t)>& fits);

/// parseTable() of a file's text.
/// @throws std::runtime_error as readBytes() and toText().
TextTable readTable(const std::filesystem::path& file,
                    const std::function<bool(std::size_t)>& fits);

/// What a row with a wrong number of fields may be, to end a message with: "; are these decimal
/// commas? ...", or nothing. @param expected number of fields.
std::string guessOfFields(const TextRow& row, std::size_t expected);

/// The same for a row in the place of "timestamp tx ty tz qx qy qz qw": other formats of poses.
std::string guessOfPose(const TextRow& row);

/// True where the whole of a field is a number, NaN and infinity included; '+' may stand before it.
bool parseNumber(std::string_view field, double& value);

/// A field as a finite number, whatever the locale.
/// @param what the field's name in the message, such as "time stamp".
/// @throws std::runtime_error with file and line where the field is anything else.
double parseFinite(const std::string& field, const std::string& what, const std::string& file,
                   std::size_t line);

/// The start of a field for a message, what cannot be seen as \xNN.
std::string printable(std::string_view field);

}  // namespace hmcdyn::support

// SPDX-License-Identifier: BSD-3-Clause
#include "support/text_table.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "support/file_kind.hpp"

namespace hmcdyn::support {
namespace {

constexpr std::string_view kBlanks = " \t\r\v\f";

bool isDigit(char c) { return c >= '0' && c <= '9'; }

bool startsWith(std::string_view text, std::string_view start) {
  return text.substr(0, start.size()) == start;
}

void appendUtf8(std::uint32_t code, std::string& text) {
  const auto add = [&text](std::uint32_t byte) { text += static_cast<char>(byte); };
  if (code < 0x80) {
    add(code);
  } else if (code < 0x800) {
    add(0xC0U | code >> 6U);
    add(0x80U | (code & 0x3FU));
  } else if (code < 0x10000) {
    add(0xE0U | code >> 12U);
    add(0x80U | (code >> 6U & 0x3FU));
    add(0x80U | (code & 0x3FU));
  } else {
    add(0xF0U | code >> 18U);
    add(0x80U | (code >> 12U & 0x3FU));
    add(0x80U | (code >> 6U & 0x3FU));
    add(0x80U | (code & 0x3FU));
  }
}

// RFC 2781; a surrogate without its partner becomes the sign for "no character".
std::string fromUtf16(std::string_view bytes, bool big_endian) {
  const auto unit = [&](std::size_t i) {
    const auto first = static_cast<unsigned char>(bytes[i]);
    const auto second = static_cast<unsigned char>(bytes[i + 1]);
    return static_cast<std::uint32_t>(big_endian ? first << 8 | second : second << 8 | first);
  };
  std::string text;
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
    std::uint32_t code = unit(i);
    if (code >= 0xD800 && code < 0xDC00 && i + 3 < bytes.size() && unit(i + 2) >= 0xDC00 &&
        unit(i + 2) < 0xE000) {
      code = 0x10000 + ((code - 0xD800) << 10U) + (unit(i + 2) - 0xDC00);
      i += 2;
    } else if (code >= 0xD800 && code < 0xE000) {
      code = 0xFFFD;
    }
    appendUtf8(code, text);
  }
  return text;
}

/// Most second bytes are 0, and none of the others, as in UTF-16 without its mark, of ASCII but for
/// a comment. @param zeros 0: the first of each two (big endian), 1: the second.
bool isUtf16(std::string_view bytes, std::size_t zeros) {
  if (bytes.size() < 4 || bytes.size() % 2 != 0) {
    return false;
  }
  std::size_t zero = 0;
  for (std::size_t i = 0; i < bytes.size(); i += 2) {
    if (bytes[i + 1 - zeros] == '\0') {
      return false;
    }
    zero += bytes[i + zeros] == '\0' ? 1 : 0;
  }
  return 4 * zero > bytes.size();  // more than half of the characters
}

/// What systems leave behind a text: zeros of a file that was not closed, DOS's end of file.
std::string_view withoutEndMarks(std::string_view text) {
  while (!text.empty() && (text.back() == '\0' || text.back() == '\x1A')) {
    text.remove_suffix(1);
  }
  return text;
}

/// Line ends of the first Macintosh, also among others; not those that belong to a '\n'.
std::string withLineFeeds(std::string text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char before = i > 0 ? text[i - 1] : ' ';
    const char after = i + 1 < text.size() ? text[i + 1] : ' ';
    if (text[i] == '\r' && before != '\n' && after != '\n' && after != '\r') {
      text[i] = '\n';
    }
  }
  return text;
}

std::string replaceAll(std::string_view text, std::string_view from, std::string_view to) {
  std::string result;
  result.reserve(text.size());
  std::size_t begin = 0;
  for (std::size_t at = text.find(from); at != std::string_view::npos;
       at = text.find(from, begin)) {
    result.append(text.substr(begin, at - begin)).append(to);
    begin = at + from.size();
  }
  return result.append(text.substr(begin));
}

/// Characters that look like one of ASCII's, or like nothing.
std::string withPlainCharacters(std::string text) {
  const bool plain = std::all_of(text.begin(), text.end(),
                                 [](char c) { return static_cast<unsigned char>(c) < 0x80; });
  if (plain) {
    return text;
  }
  constexpr std::array<std::pair<std::string_view, std::string_view>, 7> kTwins{{
      {"\xEF\xBB\xBF", ""},    // U+FEFF, the mark of the byte order, also where files were joined
      {"\xC2\xA0", " "},       // U+00A0, no-break space
      {"\xE2\x80\xAF", " "},   // U+202F, narrow no-break space
      {"\xE2\x80\x89", " "},   // U+2009, thin space
      {"\xE3\x80\x80", " "},   // U+3000, ideographic space
      {"\xE2\x88\x92", "-"},   // U+2212, minus
      {"\xE2\x80\xA8", "\n"},  // U+2028, line separator
  }};
  for (const auto& [from, to] : kTwins) {
    text = replaceAll(text, from, to);
  }
  return text;
}

std::vector<std::string> split(std::string_view line, std::string_view separators) {
  std::vector<std::string> fields;
  std::size_t begin = line.find_first_not_of(separators);
  while (begin != std::string_view::npos) {
    const std::size_t end = std::min(line.find_first_of(separators, begin), line.size());
    fields.emplace_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(separators, end);
  }
  return fields;
}

/// "-12,5": one comma, with digits on both sides, and no point.
bool hasDecimalComma(const std::string& field) {
  const std::size_t comma = field.find(',');
  return comma != std::string::npos && comma > 0 && comma + 1 < field.size() &&
         isDigit(field[comma - 1]) && isDigit(field[comma + 1]) &&
         field.find(',', comma + 1) == std::string::npos && field.find('.') == std::string::npos;
}

/// Fields by blanks alone where that fits and the commas can only be decimal points.
bool splitAtBlanks(std::string_view line, const std::function<bool(std::size_t)>& fits,
                   std::vector<std::string>& fields) {
  if (line.find(',') == std::string_view::npos) {
    return false;
  }
  std::vector<std::string> by_blanks = split(line, " \t\r\v\f;");
  const bool decimal =
      std::all_of(by_blanks.begin(), by_blanks.end(), [](const std::string& field) {
        return field.find(',') == std::string::npos || hasDecimalComma(field);
      });
  if (!decimal || !fits(by_blanks.size())) {
    return false;
  }
  for (std::string& field : by_blanks) {
    if (hasDecimalComma(field)) {
      field[field.find(',')] = '.';
    }
  }
  fields = std::move(by_blanks);
  return true;
}

/// A comma may be part of a file's name.
std::vector<std::string> splitAnywhere(std::string_view line,
                                       const std::function<bool(std::size_t)>& fits) {
  std::vector<std::string> fields = split(line, " \t\r\v\f,;");
  std::vector<std::string> by_blanks = split(line, kBlanks);
  return !fits(fields.size()) && fits(by_blanks.size()) ? by_blanks : fields;
}

bool isComment(std::string_view line) {
  return startsWith(line, "#") || startsWith(line, "%") || startsWith(line, "//");
}

/// Without a comment behind the row: a '#' with a blank before it. File names may have others.
std::string_view withoutComment(std::string_view line) {
  for (std::size_t at = line.find('#'); at != std::string_view::npos; at = line.find('#', at + 1)) {
    if (at > 0 && kBlanks.find(line[at - 1]) != std::string_view::npos) {
      return line.substr(0, at);
    }
  }
  return line;
}

/// "timestamp tx ty tz": names of columns.
bool isHeader(const std::vector<std::string>& fields) {
  return fields.size() > 1 &&
         std::all_of(fields.begin(), fields.end(), [](const std::string& field) {
           double ignored = 0.0;
           return std::isalpha(static_cast<unsigned char>(field.front())) != 0 &&
                  !parseNumber(field, ignored) && field.find_first_of("./\\") == std::string::npos;
         });
}

}  // namespace

std::runtime_error errorAt(const std::string& file, std::size_t line, const std::string& message) {
  return std::runtime_error(fmt::format("{}:{}: {}", file, line, message));
}

std::string readBytes(const std::filesystem::path& file) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) {
    throw std::runtime_error(fmt::format("{}: no such file", file.string()));
  }
  if (!std::filesystem::is_regular_file(status)) {
    throw std::runtime_error(fmt::format("{}: {}", file.string(),
                                         std::filesystem::is_directory(status)
                                             ? "is a folder; expected a file"
                                             : "is not a regular file"));
  }
  std::string bytes(std::filesystem::file_size(file), '\0');
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!stream) {
    throw std::runtime_error(
        fmt::format("{}: cannot be read{}", file.string(),
                    errno != 0 ? fmt::format(": {}", std::strerror(errno)) : std::string()));
  }
  return bytes;
}

std::string toText(const std::string& bytes, const std::string& file) {
  if (const std::string kind = kindOfBytes(bytes); !kind.empty()) {
    throw std::runtime_error(fmt::format("{}: expected text; this is {}", file, kind));
  }
  std::string text;
  if (startsWith(bytes, "\xFF\xFE")) {
    text = fromUtf16(std::string_view(bytes).substr(2), false);
  } else if (startsWith(bytes, "\xFE\xFF")) {
    text = fromUtf16(std::string_view(bytes).substr(2), true);
  } else if (isUtf16(bytes, 1) || isUtf16(bytes, 0)) {
    text = fromUtf16(bytes, isUtf16(bytes, 0));
  } else {
    text = std::string(withoutEndMarks(bytes));
  }
  if (text.find('\0') != std::string::npos) {
    throw std::runtime_error(fmt::format(
        "{}: holds bytes of value 0; expected text, not a binary file (UTF-32? Save it as "
        "UTF-8)",
        file));
  }
  return withLineFeeds(withPlainCharacters(std::move(text)));
}

TextTable parseTable(std::string_view text, const std::string& file,
                     const std::function<bool(std::size_t)>& fits) {
  TextTable table;
  std::size_t decimal_commas = 0;
  std::size_t number = 0;
  bool header_seen = false;
  while (!text.empty()) {
    ++number;
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    line.remove_prefix(std::min(line.find_first_not_of(kBlanks), line.size()));
    if (line.empty() || isComment(line)) {
      continue;
    }
    line = withoutComment(line);
    TextRow row;
    row.line = number;
    if (splitAtBlanks(line, fits, row.fields)) {
      ++decimal_commas;
    } else {
      row.fields = splitAnywhere(line, fits);
    }
    if (row.fields.empty()) {
      continue;  // separators alone
    }
    if (table.rows.empty() && !header_seen && isHeader(row.fields)) {
      header_seen = true;
      table.notes.push_back(fmt::format("{}:{}: '{} ...' is taken for the columns' names", file,
                                        number, printable(row.fields.front())));
      continue;
    }
    table.rows.push_back(std::move(row));
  }
  if (decimal_commas > 0) {
    table.notes.push_back(fmt::format("{}: {} lines have decimal commas, which are read as points",
                                      file, decimal_commas));
  }
  return table;
}

TextTable readTable(const std::filesystem::path& file,
                    const std::function<bool(std::size_t)>& fits) {
  return parseTable(toText(readBytes(file), file.string()), file.string(), fits);
}

std::string guessOfFields(const TextRow& row, std::size_t expected) {
  if (std::string markup = guessOfMarkup(row.fields.front()); !markup.empty()) {
    return markup;
  }
  const bool points = std::any_of(row.fields.begin(), row.fields.end(), [](const std::string& f) {
    return f.find('.') != std::string::npos;
  });
  if (row.fields.size() == 2 * expected && !points) {
    return fmt::format(
        "; are these decimal commas ('{},{}')? Write points, or separate the numbers by blanks",
        printable(row.fields[0]), printable(row.fields[1]));
  }
  return {};
}

std::string guessOfPose(const TextRow& row) {
  constexpr std::size_t kFields = 8;
  const std::size_t count = row.fields.size();
  if (std::string markup = guessOfMarkup(row.fields.front()); !markup.empty()) {
    return markup;
  }
  const bool is_matrix = count == 16 && std::equal(row.fields.begin() + 12, row.fields.begin() + 14,
                                                   row.fields.begin() + 13);
  double last = 0.0;
  if (is_matrix && parseNumber(row.fields.back(), last) && last == 1.0) {
    return "; sixteen numbers are a matrix of 4 x 4, which has no time stamp: convert the file";
  }
  switch (count) {
    case 4:
      return "; four numbers are a time and a position without its rotation, or a matrix's row";
    case 7:
      return "; of seven numbers, is the time stamp missing, or is the rotation in angles?";
    case 9:
      return "; of nine numbers, is one a frame number? Leave it out";
    case 12:
      return "; twelve numbers are a pose of KITTI's, which has no time stamp: convert the file";
    case 13:
      return "; thirteen numbers are a frame number or time stamp and a pose as KITTI's: convert "
             "the file";
    case 17:
      return "; seventeen are a state of EuRoC's (ns, position, then qw first): convert the file";
    default:
      return guessOfFields(row, kFields);
  }
}

bool parseNumber(std::string_view field, double& value) {
  if (!field.empty() && field.front() == '+') {
    field.remove_prefix(1);
    if (!field.empty() && (field.front() == '-' || field.front() == '+')) {
      return false;
    }
  }
  const char* const end = field.data() + field.size();
  const std::from_chars_result parsed = std::from_chars(field.data(), end, value);
  return parsed.ec == std::errc{} && parsed.ptr == end && !field.empty();
}

std::string printable(std::string_view field) {
  constexpr std::size_t kMost = 40;  // a binary file has long "words"
  std::string text;
  for (const char c : field.substr(0, kMost)) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte >= 0x7F) {
      text += fmt::format("\\x{:02X}", byte);
    } else {
      text += c;
    }
  }
  return text;
}

double parseFinite(const std::string& field, const std::string& what, const std::string& file,
                   std::size_t line) {
  double value = 0.0;
  if (parseNumber(field, value) && std::isfinite(value)) {
    return value;
  }
  throw errorAt(file, line,
                fmt::format("{} is '{}'; expected a finite number{}", what, printable(field),
                            hasDecimalComma(field) ? ", with a point in place of the comma" : ""));
}

}  // namespace hmcdyn::support

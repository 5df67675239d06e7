// SPDX-License-Identifier: BSD-3-Clause
#include "slam/input/camera/settings_file.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include "slam/input/dataset/file_io.hpp"
#include "support/text_table.hpp"

namespace hmcdyn::slam {
namespace {

bool isKeyCharacter(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.' || c == '-' ||
         c == '"' || c == '\'';
}

std::size_t indentOf(const std::string& line) {
  return std::min(line.find_first_not_of(' '), line.size());
}

/// Where the colon behind a line's key is; npos where the line does not begin with one.
std::size_t colonOf(const std::string& line) {
  std::size_t at = indentOf(line);
  const std::size_t begin = at;
  while (at < line.size() && isKeyCharacter(line[at])) {
    ++at;
  }
  const std::size_t end = at;
  while (at < line.size() && line[at] == ' ') {
    ++at;
  }
  return end > begin && line[begin] != '-' && at < line.size() && line[at] == ':'
             ? at
             : std::string::npos;
}

bool isLeftOut(const std::string& line) {
  const std::size_t begin = line.find_first_not_of(' ');
  return begin == std::string::npos || line[begin] == '#';
}

/// "%YAML:1.0", "---" and "..." are at the start of a line.
bool isMark(const std::string& line) {
  return line.rfind("%YAML", 0) == 0 || line.rfind("---", 0) == 0 || line.rfind("...", 0) == 0;
}

/// The lines without tabs and white space at their ends, and with a blank behind each key's colon.
std::vector<std::string> plainLines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    std::replace(line.begin(), line.end(), '\t', ' ');
    line.erase(line.find_last_not_of(" \r") + 1);
    const std::size_t colon = isLeftOut(line) ? std::string::npos : colonOf(line);
    if (colon != std::string::npos && colon + 1 < line.size() && line[colon + 1] != ' ') {
      line.insert(colon + 1, " ");
    }
    lines.push_back(std::move(line));
  }
  return lines;
}

std::string trimmed(const std::string& text) {
  const std::size_t begin = text.find_first_not_of(' ');
  return begin == std::string::npos ? std::string() : text.substr(begin);
}

/// All scalars of a list, in order. @return false where it holds anything else.
bool collectScalars(const YAML::Node& list, std::vector<std::string>& scalars) {
  return std::all_of(list.begin(), list.end(), [&](const YAML::Node& element) {
    if (element.IsSequence()) {
      return collectScalars(element, scalars);
    }
    scalars.push_back(element.IsScalar() ? element.Scalar() : std::string());
    return element.IsScalar();
  });
}

Setting settingOf(const std::string& key, const YAML::Node& value, std::size_t line) {
  Setting setting;
  setting.key = key;
  setting.line = line;
  if (value.IsScalar()) {
    setting.scalars.push_back(value.Scalar());
    setting.text = value.Scalar();
  } else if (value.IsSequence()) {
    setting.is_list = true;
    if (!collectScalars(value, setting.scalars)) {
      setting.error = "holds what is no number";
    }
  }
  return setting;
}

/// The values below a node, keys joined by '.'. @param line of the node's key in the file, from 1.
void flatten(const std::string& key, const YAML::Node& value, std::size_t line,
             std::size_t first_line, std::vector<Setting>& settings) {
  if (!value.IsMap()) {
    settings.push_back(settingOf(key, value, line));
    return;
  }
  for (const auto& entry : value) {
    std::string name = key.empty() ? "" : key + ".";
    name += entry.first.IsScalar() ? entry.first.Scalar() : "?";
    const YAML::Mark mark = entry.first.Mark();
    flatten(name, entry.second,
            first_line + (mark.is_null() ? 0 : static_cast<std::size_t>(mark.line)), first_line,
            settings);
  }
}

/// Whether a line sets a key as shells and INI files do: "key = value".
bool setsByEqualsSign(const std::string& line, const std::string& key) {
  const std::size_t begin = indentOf(line);
  const std::size_t after = line.find_first_not_of(' ', begin + key.size());
  return line.compare(begin, key.size(), key) == 0 && after != std::string::npos &&
         line[after] == '=';
}

/// "CAMERA.FX" and "Camera.fx".
bool differsInCase(const std::string& a, const std::string& b) {
  return a != b &&
         std::equal(a.begin(), a.end(), b.begin(), b.end(), [](unsigned char x, unsigned char y) {
           return std::tolower(x) == std::tolower(y);
         });
}

/// To end a message about a value that is no number: what it may be.
std::string guessOfValue(const Setting& setting) {
  const std::string& text = setting.text;
  if (text.find("%YAML") != std::string::npos || text.find(": ") != std::string::npos) {
    return "; are these two lines in one?";
  }
  const std::size_t comma = text.find(',');
  double ignored = 0.0;
  if (comma != std::string::npos &&
      support::parseNumber(std::string(text).replace(comma, 1, "."), ignored)) {
    return "; is the comma a decimal point? Write '.'";
  }
  // What files that are to be filled in hold in place of numbers.
  const bool is_template = text.find_first_of("<>{}$@?") != std::string::npos ||
                           text.find("XXX") != std::string::npos ||
                           text.find("TODO") != std::string::npos;
  return text.empty() || text == "~" || text == "null" || is_template
             ? "; was a template left unfilled?"
             : "";
}

/// What a file without a single "key: value" may be, by its first line that is no comment.
std::string guessOfFile(const std::vector<std::string>& lines) {
  const auto first = std::find_if_not(lines.begin(), lines.end(), [](const std::string& line) {
    return isLeftOut(line) || isMark(line) || line.front() == '[';
  });
  if (first == lines.end()) {
    return {};
  }
  if (first->find('=') != std::string::npos) {
    return "; its lines have equals signs, as INI files do: write \"key: value\"";
  }
  std::istringstream stream(*first);
  std::vector<std::string> fields;
  for (std::string field; stream >> field;) {
    fields.push_back(std::move(field));
  }
  double ignored = 0.0;
  const bool numbers = std::all_of(
      fields.begin(), fields.end(),
      [&ignored](const std::string& field) { return support::parseNumber(field, ignored); });
  if (numbers) {
    return "; numbers alone do not say what they are: write \"fx: ...\", \"fy: ...\", \"cx: ...\", "
           "\"cy: ...\", \"depth_factor: ...\"";
  }
  constexpr std::size_t kColmap = 5;  // number, model, width, height, and at least one parameter
  const bool is_model = fields.size() >= kColmap &&
                        std::all_of(fields[1].begin(), fields[1].end(), [](unsigned char c) {
                          return std::isupper(c) != 0 || c == '_' || std::isdigit(c) != 0;
                        });
  return is_model ? "; is this COLMAP's cameras.txt? Write width, height, fx, fy, cx, cy and "
                    "depth_factor"
                  : "";
}

}  // namespace

SettingsFile::SettingsFile(std::filesystem::path file) : file_(std::move(file)) {
  const std::string text = support::toText(readFile(file_), file_.string());
  if (text.rfind("<?xml", 0) == 0) {
    throw failure("is XML; expected YAML, lines \"key: value\"");
  }
  lines_ = plainLines(text);
  std::size_t base = std::string::npos;  // what the outermost keys are indented by
  std::vector<std::string> block;
  std::size_t first = 0;
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    const std::string& line = lines_[i];
    const bool key = !isLeftOut(line) && !isMark(line) && colonOf(line) != std::string::npos;
    const bool braces = base == std::string::npos && line.rfind('{', 0) == 0;
    if ((key && (base == std::string::npos || indentOf(line) <= base)) || braces) {
      readBlock(block, first);
      base = std::min(base, indentOf(line));
      block = {line};
      first = i;
    } else if (!block.empty()) {
      block.push_back(isMark(line) ? std::string() : line);
    }
  }
  readBlock(block, first);
  if (settings_.empty()) {
    throw failure("has no settings; expected lines \"key: value\"" + guessOfFile(lines_));
  }
}

void SettingsFile::readBlock(const std::vector<std::string>& lines, std::size_t first) {
  if (lines.empty()) {
    return;
  }
  const std::string text = fmt::format("{}\n", fmt::join(lines, "\n"));
  const std::size_t before = settings_.size();
  try {
    const YAML::Node node = YAML::Load(text);
    if (node.IsMap()) {
      flatten("", node, first + 1, first + 1, settings_);
    }
  } catch (const YAML::Exception& error) {
    settings_.resize(before);
    const std::size_t colon = std::min(colonOf(lines.front()), lines.front().size());
    Setting setting;
    setting.key = trimmed(lines.front().substr(0, colon));
    setting.line = first + 1;
    setting.text = trimmed(lines.front().substr(std::min(colon + 1, lines.front().size())));
    setting.error = "is not YAML: " + error.msg;
    settings_.push_back(std::move(setting));
  }
}

const Setting* SettingsFile::find(const std::string& key) const {
  const Setting* found = nullptr;
  for (const Setting& setting : settings_) {
    if (setting.key != key) {
      continue;
    }
    if (found != nullptr && (found->scalars != setting.scalars || found->text != setting.text)) {
      throw failure(fmt::format(
          "{} is given twice, '{}' in line {} and '{}' in line {}; expected one of them", key,
          support::printable(found->text), found->line, support::printable(setting.text),
          setting.line));
    }
    found = found == nullptr ? &setting : found;
  }
  return found;
}

std::string SettingsFile::firstOf(const std::vector<std::string>& keys) const {
  const auto found =
      std::find_if(keys.begin(), keys.end(), [this](const std::string& key) { return has(key); });
  return found == keys.end() ? std::string() : *found;
}

const Setting& SettingsFile::required(const std::string& key) const {
  const Setting* const setting = find(key);
  if (setting == nullptr) {
    const auto below = std::find_if(settings_.begin(), settings_.end(), [&](const Setting& other) {
      return other.key.rfind(key + ".", 0) == 0;
    });
    const auto equals = std::find_if(lines_.begin(), lines_.end(), [&](const std::string& line) {
      return setsByEqualsSign(line, key);
    });
    if (equals != lines_.end()) {
      throw errorAt(file_, static_cast<std::size_t>(equals - lines_.begin()) + 1,
                    fmt::format("'{}' has an equals sign; expected \"{}: value\"",
                                support::printable(trimmed(*equals)), key));
    }
    const auto other = std::find_if(settings_.begin(), settings_.end(), [&](const Setting& given) {
      return differsInCase(given.key, key);
    });
    if (other != settings_.end()) {
      throw errorAt(file_, other->line,
                    fmt::format("'{}' is written in other letters; expected {}",
                                support::printable(other->key), key));
    }
    throw below == settings_.end()
        ? failure(key, "is missing")
        : errorAt(file_, below->line,
                  key + " has keys below it; expected a value; was a template left unfilled?");
  }
  if (!setting->error.empty()) {
    throw failure(key, fmt::format("{} ('{}'){}", setting->error, support::printable(setting->text),
                                   guessOfValue(*setting)));
  }
  return *setting;
}

double SettingsFile::toNumber(const Setting& setting, const std::string& scalar) const {
  double number = 0.0;
  if (!support::parseNumber(scalar, number) || !std::isfinite(number)) {
    throw failure(setting.key, fmt::format("is '{}'; expected a number{}",
                                           support::printable(scalar), guessOfValue(setting)));
  }
  return number;
}

double SettingsFile::number(const std::string& key) const {
  const Setting& setting = required(key);
  if (setting.is_list) {
    throw errorAt(file_, setting.line, key + ": expected a number");
  }
  if (setting.scalars.empty()) {
    throw failure(key, "has no value; expected a number; was a template left unfilled?");
  }
  return toNumber(setting, setting.scalars.front());
}

double SettingsFile::positive(const std::string& key) const {
  const double value = number(key);
  if (!(value > 0.0)) {
    throw failure(key, fmt::format("is {}; expected a number above 0", value));
  }
  return value;
}

int SettingsFile::positiveInteger(const std::string& key) const {
  const double value = positive(key);
  if (value != std::floor(value) || value > std::numeric_limits<int>::max()) {
    throw failure(key, fmt::format("is {}; expected a whole number above 0", value));
  }
  return static_cast<int>(value);
}

std::string SettingsFile::text(const std::string& key) const { return required(key).text; }

std::vector<double> SettingsFile::numbers(const std::string& key) const {
  const Setting& setting = required(key);
  if (!setting.is_list) {
    throw errorAt(file_, setting.line, key + ": expected a list of numbers");
  }
  std::vector<double> values;
  values.reserve(setting.scalars.size());
  for (const std::string& scalar : setting.scalars) {
    values.push_back(toNumber(setting, scalar));
  }
  return values;
}

std::runtime_error SettingsFile::failure(const std::string& key, const std::string& message) const {
  const auto found = std::find_if(settings_.begin(), settings_.end(),
                                  [&](const Setting& setting) { return setting.key == key; });
  return found == settings_.end() ? failure(key + " " + message)
                                  : errorAt(file_, found->line, key + " " + message);
}

std::runtime_error SettingsFile::failure(const std::string& message) const {
  return std::runtime_error(fmt::format("{}: {}", file_.string(), message));
}

}  // namespace hmcdyn::slam

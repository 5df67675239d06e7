// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/paper_results.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "support/text_table.hpp"

namespace hmcdyn::evaluate {
namespace {

constexpr const char* kHeader = "table,sequence,system,metric,value";

[[noreturn]] void fail(const std::filesystem::path& file, std::size_t line,
                       const std::string& what) {
  throw std::runtime_error(fmt::format("{}:{}: {}", file.string(), line, what));
}

PaperValue parseRow(const std::string& text, const std::filesystem::path& file, std::size_t line) {
  std::vector<std::string> fields;
  std::istringstream row(text);
  for (std::string field; std::getline(row, field, ',');) {
    fields.push_back(field);
  }
  if (fields.size() != 5) {
    fail(file, line, fmt::format("expected 5 fields, found {}", fields.size()));
  }
  if (std::any_of(fields.begin(), fields.end(), [](const auto& field) { return field.empty(); })) {
    fail(file, line, fmt::format("a field of '{}' is empty; expected {}", text, kHeader));
  }
  double value = 0.0;
  const char* const end = fields[4].data() + fields[4].size();
  const auto [rest, error] = std::from_chars(fields[4].data(), end, value);
  if (error != std::errc() || rest != end || !std::isfinite(value)) {
    fail(file, line, "'" + fields[4] + "' is no number");
  }
  return {fields[0], fields[1], fields[2], fields[3], value};
}

}  // namespace

std::vector<PaperValue> readPaperResults(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) {
    throw std::runtime_error(file.string() + ": cannot be read");
  }
  std::istringstream stream(support::toText(support::readBytes(file), file.string()));
  std::vector<PaperValue> values;
  bool has_header = false;
  std::string text;
  for (std::size_t line = 1; std::getline(stream, text); ++line) {
    text.erase(text.find_last_not_of(" \t\r") + 1);
    if (text.empty() || text.front() == '#') {
      continue;
    }
    if (has_header) {
      values.push_back(parseRow(text, file, line));
    } else if (text == kHeader) {
      has_header = true;
    } else {
      fail(file, line, std::string("expected the header '") + kHeader + "'");
    }
  }
  if (!has_header) {
    throw std::runtime_error(file.string() + ": expected the header '" + kHeader + "'");
  }
  return values;
}

std::optional<double> findPaperValue(const std::vector<PaperValue>& values,
                                     const std::string& table, const std::string& sequence,
                                     const std::string& system, const std::string& metric) {
  const auto found = std::find_if(values.begin(), values.end(), [&](const PaperValue& value) {
    return value.table == table && value.sequence == sequence && value.system == system &&
           value.metric == metric;
  });
  return found == values.end() ? std::nullopt : std::optional<double>(found->value);
}

std::string paperSequence(const std::string& folder) {
  constexpr std::array<std::string_view, 3> kPrefixes{"rgbd_dataset_freiburg3_", "rgbd_bonn_", ""};
  constexpr std::array<std::pair<std::string_view, const char*>, 10> kNames{
      {{"crowd", "CROWD"},
       {"crowd2", "CROWD2"},
       {"crowd3", "CROWD3"},
       {"synchronous2", "SYCH2"},
       {"sitting_halfsphere", "SITHALF"},
       {"sitting_static", "SITSTATIC"},
       {"walking_halfsphere", "WALKHALF"},
       {"walking_xyz", "WALKXYZ"},
       {"walking_static", "WALKSTATIC"},
       {"walking_rpy", "WALKRPY"}}};
  for (const std::string_view prefix : kPrefixes) {
    if (folder.compare(0, prefix.size(), prefix) != 0) {
      continue;
    }
    for (const auto& [name, paper] : kNames) {
      if (std::string_view(folder).substr(prefix.size()) == name) {
        return paper;
      }
    }
  }
  return {};
}

}  // namespace hmcdyn::evaluate

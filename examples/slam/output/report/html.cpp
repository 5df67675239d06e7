// SPDX-License-Identifier: BSD-3-Clause
#include "slam/output/report/html.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include <nlohmann/json.hpp>

namespace hmcdyn::slam {
namespace {

using Json = nlohmann::json;

/// Valid UTF-8: what a lenient dump writes, read back.
std::string validUtf8(const std::string& text) {
  return Json::parse(Json(text).dump(-1, ' ', false, Json::error_handler_t::replace))
      .get<std::string>();
}

std::string leafText(const Json& leaf) {
  return leaf.is_string() ? leaf.get<std::string>()
                          : leaf.dump(-1, ' ', false, Json::error_handler_t::replace);
}

void collectLeaves(const Json& json, const std::string& name,
                   std::vector<std::vector<std::string>>& rows) {
  if (!json.is_object()) {
    rows.push_back({name, leafText(json)});
    return;
  }
  for (const auto& [key, value] : json.items()) {
    std::string path = name;
    path += path.empty() ? "" : ".";
    collectLeaves(value, path += key, rows);
  }
}

std::string rowHtml(const char* tag, const std::vector<std::string>& cells, bool numbers) {
  std::string html = "<tr>";
  for (std::size_t i = 0; i < cells.size(); ++i) {
    html += std::string("<") + tag + (numbers && i > 0 ? " class=\"n\">" : ">") +
            escapeHtml(cells[i]) + "</" + tag + ">";
  }
  return html + "</tr>\n";
}

std::string tableHtml(const std::vector<std::string>& head,
                      const std::vector<std::vector<std::string>>& rows, bool numbers) {
  std::string html = "<div class=\"scroll\"><table>\n";
  if (!head.empty()) {
    html += "<thead>" + rowHtml("th", head, numbers) + "</thead>\n";
  }
  html += "<tbody>\n";
  for (const std::vector<std::string>& row : rows) {
    html += rowHtml("td", row, numbers);
  }
  return html + "</tbody></table></div>\n";
}

}  // namespace

std::string escapeHtml(const std::string& text) {
  std::string html;
  for (const char c : validUtf8(text)) {
    switch (c) {
      case '&':
        html += "&amp;";
        break;
      case '<':
        html += "&lt;";
        break;
      case '>':
        html += "&gt;";
        break;
      case '"':
        html += "&quot;";
        break;
      case '\'':
        html += "&#39;";
        break;
      default:
        html += static_cast<unsigned char>(c) < 0x20U || c == '\x7f' ? ' ' : c;
    }
  }
  return html;
}

std::string scriptJson(const Json& json) {
  std::string safe;
  for (const char c : json.dump(-1, ' ', true, Json::error_handler_t::replace)) {
    if (c == '<') {
      safe += "\\u003c";
    } else {
      safe += c;
    }
  }
  return safe;
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = i; k < i + 3; ++k) {
      group = group << 8U | (k < bytes.size() ? static_cast<unsigned char>(bytes[k]) : 0U);
    }
    const std::size_t digits = std::min<std::size_t>(bytes.size() - i, 3) + 1;
    for (std::size_t k = 0; k < 4; ++k) {
      text += k < digits ? kDigits[group >> (18U - 6U * k) & 63U] : '=';
    }
  }
  return text;
}

std::string htmlTable(const std::vector<std::string>& head,
                      const std::vector<std::vector<std::string>>& rows) {
  return tableHtml(head, rows, true);
}

std::string jsonTable(const Json& json) {
  std::vector<std::vector<std::string>> rows;
  if (json.is_object()) {
    collectLeaves(json, "", rows);
  }
  return rows.empty() ? std::string() : tableHtml({}, rows, false);
}

}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace hmcdyn::slam {

/// The text for an element's content or a quoted attribute: markup escaped, bytes that are no
/// UTF-8 as U+FFFD, control characters as blanks.
std::string escapeHtml(const std::string& text);

/// JSON for the inside of a script element: ASCII only, without '<', so that no text in it can end
/// the element. Numbers that are not finite become null.
std::string scriptJson(const nlohmann::json& json);

/// Base64 (RFC 4648) with padding.
std::string base64(std::string_view bytes);

/// A table; the first column is text, the others are numbers. Cells are escaped here.
std::string htmlTable(const std::vector<std::string>& head,
                      const std::vector<std::vector<std::string>>& rows);

/// A table of the leaves of a JSON object, names joined by dots; empty for none.
std::string jsonTable(const nlohmann::json& json);

}  // namespace hmcdyn::slam

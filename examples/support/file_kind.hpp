// SPDX-License-Identifier: BSD-3-Clause
// What a file is that was given for another: told by its first bytes, or by a field of its text.
#pragma once

#include <string>
#include <string_view>

namespace hmcdyn::support {

/// "a gzip archive", "a PNG image" and so on, by the first bytes; empty where they say nothing.
std::string kindOfBytes(std::string_view bytes);

/// To end a message about the first field of a table's row with: "; is this JSON? ..." or XML;
/// nothing where it is neither. A number in brackets is no JSON.
std::string guessOfMarkup(std::string_view field);

}  // namespace hmcdyn::support

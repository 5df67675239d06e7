// SPDX-License-Identifier: BSD-3-Clause
// The headers' comments as docstrings.
#pragma once

namespace hmcdyn::python {

/// The comment of a function, a type, or "Type::member", as extract_comments.py found it.
/// @throws std::logic_error where there is none: it is misspelt, or the header has changed.
const char* commentOf(const char* name);

}  // namespace hmcdyn::python

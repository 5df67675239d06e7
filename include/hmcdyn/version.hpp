// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The library's version; the build reads it from here.
#pragma once

#include <hmcdyn/detail/requirements.hpp>

// NOLINTBEGIN(cppcoreguidelines-macro-usage): for the preprocessor of whoever includes this
/// Breaking changes; while it is 0, so does the minor version.
#define HMCDYN_VERSION_MAJOR 0
/// New features.
#define HMCDYN_VERSION_MINOR 1
/// Mended errors.
#define HMCDYN_VERSION_PATCH 0
/// "major.minor.patch".
#define HMCDYN_VERSION_STRING "0.1.0"
// NOLINTEND(cppcoreguidelines-macro-usage)

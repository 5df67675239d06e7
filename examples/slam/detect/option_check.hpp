// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>

#include <fmt/format.h>

namespace hmcdyn::slam {

/// Throws std::invalid_argument naming the option, its value and what is expected, unless `good`.
inline void requireOption(bool good, const char* option, double value, const char* expected) {
  if (!good) {
    throw std::invalid_argument(fmt::format("{} is {}; expected {}", option, value, expected));
  }
}

}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>

namespace hmcdyn::test {

inline constexpr float kInfinity = std::numeric_limits<float>::infinity();
inline constexpr int kChairClassId = 56;  ///< Of COCO's classes.

}  // namespace hmcdyn::test

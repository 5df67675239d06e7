// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace hmcdyn::synthesize {

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr float kPiF = 3.14159265358979323846f;

}  // namespace hmcdyn::synthesize

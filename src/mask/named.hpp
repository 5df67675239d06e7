// SPDX-License-Identifier: BSD-3-Clause
// Which pixels a detector's boxes or masks name.
#pragma once

#include <cstdint>
#include <vector>

#include "mask/small_frame.hpp"

namespace hmcdyn::internal {

/// What boxes and masks say of a pixel.
inline constexpr std::uint8_t kInBox = 1;  ///< It lies in a box, before or behind what is named.
inline constexpr std::uint8_t kNamed = 2;  ///< It belongs to something that may move.

/// Nothing (0), kInBox or kNamed for each pixel; empty without boxes and masks. A box names the
/// pixels that are about as far as what is in its middle.
/// @param reuse its memory is taken over. @param scratch reused.
std::vector<std::uint8_t> namedPixels(const MotionMaskFrame& frame, const SmallFrame& small,
                                      int reduction, float box_depth,
                                      std::vector<std::uint8_t> reuse, std::vector<float>& scratch);

}  // namespace hmcdyn::internal

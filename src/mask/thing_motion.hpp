// SPDX-License-Identifier: BSD-3-Clause
// How fast a thing moves: where its pixels are found in an earlier image.
#pragma once

#include <cstdint>
#include <vector>

#include "mask/things.hpp"

namespace hmcdyn::internal {

/// Mean velocity (m/s, world) of a thing's pixels since a frame about a tenth of a second ago.
struct ThingMotion {
  bool found = false;
  std::array<float, 3> velocity = {0, 0, 0};
};
ThingMotion motionOfThing(const ThingsInput& input, const std::uint32_t* begin,
                          const std::uint32_t* end);

}  // namespace hmcdyn::internal

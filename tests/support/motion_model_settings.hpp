// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include <hmcdyn/steps/fundamental.hpp>

#include "two_view_scene.hpp"

namespace hmcdyn::test {

constexpr double kTrackedNoise = 0.15;  ///< What tracked key points have (px).

/// Every option set.
inline TwoViewOptions fixedTwoViewOptions() {
  TwoViewOptions options;
  options.min_matches = 12;
  options.min_background_matches = 60;
  options.min_background_cells = 5;
  options.inlier_threshold = 0.5f;
  options.confidence = 0.999;
  options.max_iterations = 2000;
  options.seed = 1;
  options.still_share = 0.9f;
  options.still_displacement = 0.35f;
  options.min_conditioning = 2.0f;
  options.min_homography_share = 0.6f;
  return options;
}

/// Points as they are tracked.
inline SceneSettings noisy(std::uint32_t seed, std::size_t points = 300) {
  SceneSettings settings;
  settings.points = points;
  settings.noise = kTrackedNoise;
  settings.seed = seed;
  return settings;
}

}  // namespace hmcdyn::test

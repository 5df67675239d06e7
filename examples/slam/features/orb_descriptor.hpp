// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

#include <opencv2/core.hpp>

#include "slam/features/hamming_distance.hpp"
#include "slam/features/orb_pattern.hpp"

namespace hmcdyn::slam {

/// Pixels around a key point that its orientation and its descriptor read.
inline constexpr int kOrbMargin = kPatternRadius + 1;

using OrbDescriptor = std::array<std::uint8_t, kDescriptorBytes>;

/// Direction from a corner to the intensity centroid (Rosin 1999; Rublee et al. 2011, sec. 3.2) of
/// the disc of radius 15 px around it: a unit vector in image axes (x right, y down); (1, 0) where
/// the centroid is the corner itself. The pixel must lie kOrbMargin inside the 8-bit grey image.
cv::Point2f centroidDirection(const cv::Mat& image, int x, int y);

/// Steered BRIEF (Rublee et al. 2011, sec. 4.1): the pattern turned into `direction` and compared
/// on a smoothed 8-bit grey image, kOrbMargin inside it.
OrbDescriptor describe(const cv::Mat& smooth, int x, int y, cv::Point2f direction,
                       const OrbPattern& pattern);

}  // namespace hmcdyn::slam

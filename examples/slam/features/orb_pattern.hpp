// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>

namespace hmcdyn::slam {

/// Tests of a descriptor: one bit each.
inline constexpr std::size_t kDescriptorBits = 256;

/// No test reaches farther from the key point than this (px of the pyramid level), however rotated.
inline constexpr int kPatternRadius = 18;

/// A key point looks to the intensity centroid of a disc with this radius (px of the pyramid
/// level).
inline constexpr int kCentroidRadius = 15;

/// Where a descriptor samples the patch, relative to the key point (px). Bit i is set where point i
/// is darker than point i + 256.
struct OrbPattern {
  std::array<float, 2 * kDescriptorBits> x{};
  std::array<float, 2 * kDescriptorBits> y{};
};

/// Tests drawn as in BRIEF (Calonder et al. 2010), both points from a normal distribution around
/// the key point, and selected as ORB does (Rublee et al. 2011, sec. 4.3): unbiased bits of high
/// variance and low correlation, in a greedy search. ORB learns bias and correlation from images;
/// here they follow from a model of the patch, a stationary Gaussian random field turned so that
/// its intensity centroid lies on the x axis. Always the same pattern.
OrbPattern makeOrbPattern();

}  // namespace hmcdyn::slam

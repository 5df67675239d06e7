// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "calibrate/depth_samples.hpp"
#include "slam/input/camera/depth_correction.hpp"

namespace hmcdyn::calibrate {

/// A measured number and whether the recording shows it at all.
struct Estimate {
  double value = 0.0;
  double deviation = 0.0;   ///< Standard deviation, by bootstrap over the tracks.
  bool observable = false;  ///< False: `value` means nothing.
};

/// Where and when depth was taken, against the colour image it belongs to.
struct DepthToColor {
  Estimate shift_u;         ///< Depth pixel (u, v) shows what colour shows at (u, v) + shift (px).
  Estimate shift_v;         ///< The same (px).
  Estimate delay;           ///< Depth was taken so long after the colour image (s).
  std::size_t samples = 0;  ///< That had a say.
};

struct DepthToColorOptions {
  double largest_shift = 3.0;    ///< Looked for, to either side (px).
  double shift_step = 0.5;       ///< (px)
  double largest_delay = 0.030;  ///< Looked for, to either side (s).
  double delay_step = 0.005;     ///< (s)
  /// What a depth map must say around a point for its place to matter: the share of the depth by
  /// which depths differ there.
  double least_contrast = 0.03;
  double shift_deviation = 0.3;    ///< Observable up to this (px).
  double delay_deviation = 0.004;  ///< Observable up to this (s).
  std::size_t least_samples = 200;
  int resamplings = 40;    ///< Of the bootstrap, >= 2.
  std::uint64_t seed = 1;  ///< Of the bootstrap.
};

/// Looks where around a triangulated point its depth is found in the depth image: at slanted
/// surfaces and beside edges only one place and one time have it. The sum over all points of the
/// squared error, cut off at three standard deviations, is searched on a grid of shifts and delays
/// and refined by a parabola. A value at the grid's border is not observable. A hole in the depth
/// image speaks neither for nor against its place.
/// @param correction is applied first: a bias would pass for a shift on a slanted floor.
/// @param deviation of a corrected depth, as a share of it.
DepthToColor depthToColor(const std::vector<CalibrationImage>& images,
                          const std::vector<DepthSample>& samples,
                          const slam::DepthCorrection& correction, double truth_scale,
                          double deviation, const DepthToColorOptions& options = {});

}  // namespace hmcdyn::calibrate

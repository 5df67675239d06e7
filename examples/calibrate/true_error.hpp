// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

#include <opencv2/core.hpp>

#include "calibrate/correction_fit.hpp"
#include "calibrate/depth_samples.hpp"

namespace hmcdyn::calibrate {

/// What is wrong with a rendered camera, as `hmcdyn_synthesize --noise kinect_systematic` tells:
/// z_measured = z (1 + scale) + quadratic(u, v) z^2.
struct TrueError {
  double scale = 0.0;
  slam::DepthCorrection quadratic;  ///< Its grid alone counts (1/m).
  cv::Point2d shift;                ///< Of the registration, as DepthToColor has it (px).
};

/// @throws std::runtime_error naming the file where it is missing or has other content.
TrueError readTrueError(const std::filesystem::path& file);

/// How much of a known error a correction takes out.
struct Recovery {
  double before = 0.0;  ///< RMS of the true relative error.
  double after = 0.0;   ///< RMS of what the correction leaves of it.
  double left() const { return before > 0.0 ? after / before : 0.0; }  ///< Share, 0 = all gone.
};

/// At the samples' places and true depths, without noise. Without a known scale the mean relative
/// error is taken out of both: nobody could have measured it.
Recovery recovery(const TrueError& error, const std::vector<DepthSample>& samples,
                  const CorrectionFit& fit, bool scale_known, cv::Size image);

}  // namespace hmcdyn::calibrate

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include "calibrate/run.hpp"

namespace hmcdyn::calibrate {

/// A picture of 1600 x 1050 pixels (8-bit BGR): over the range, the bias before and after the
/// correction, and noise and systematic error with the model written; below, over the image, by
/// how much the correction changes a depth of 1, 2 and 3 m.
cv::Mat drawCalibration(const Calibration& calibration);

}  // namespace hmcdyn::calibrate

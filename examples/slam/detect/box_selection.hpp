// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include <hmcdyn/steps/box_carrier.hpp>
#include <hmcdyn/types.hpp>

#include "slam/detect/detector_options.hpp"

namespace hmcdyn::slam {

/// @throws std::invalid_argument unless the image is CV_8UC3 and not empty.
void checkColorImage(const cv::Mat& bgr);

/// The boxes of the wanted classes whose score reaches the threshold.
std::vector<DetectionBox> keepWanted(const std::vector<DetectionBox>& boxes,
                                     const DetectorOptions& options);

/// Greedy non-maximum suppression within each class: a box whose intersection over union with a
/// stronger one is above the threshold is left out, and so is one with a score of 0. Strongest
/// first; equal scores keep their order.
std::vector<DetectionBox> suppressOverlaps(const std::vector<DetectionBox>& boxes,
                                           float nms_threshold);

}  // namespace hmcdyn::slam

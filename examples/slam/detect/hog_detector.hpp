// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "slam/detect/detector.hpp"
#include "slam/detect/detector_options.hpp"

namespace hmcdyn::slam {

/// OpenCV's people detector: histograms of oriented gradients under a linear classifier (Dalal
/// and Triggs, CVPR 2005). Needs no model, and finds people who stand upright and are seen from
/// head to foot, nobody in an image below 64 x 128 pixels. Its score is 1 - exp(-m), m >= 0 being
/// the classifier's margin: a rank between 0 and 1, not a probability.
std::unique_ptr<ObjectDetector> makeHogDetector(const DetectorOptions& options);

}  // namespace hmcdyn::slam

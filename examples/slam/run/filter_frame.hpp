// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <hmcdyn/frame_filter.hpp>

#include "slam/detect/frame_mask.hpp"
#include "slam/features/frame.hpp"
#include "slam/input/dataset/frame.hpp"
#include "slam/track/tracker.hpp"

namespace hmcdyn::slam {

/// Filters the frame's key points and writes labels and weights into it, and tells the filter where
/// the tracker expects the camera.
/// @param image undistorted. @param mask takes the place of the boxes where it is not empty.
FrameFilterResult filterFrame(const RgbdFrame& image, const std::vector<DetectionBox>& boxes,
                              const FrameMask& mask, const Tracker& tracker, FrameFilter& filter,
                              Frame& frame);

}  // namespace hmcdyn::slam

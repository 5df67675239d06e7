// SPDX-License-Identifier: BSD-3-Clause
// What a front end hands over: checked, and as the library's arrays.
#pragma once

#include <vector>

#include <hmcdyn/frame_filter.hpp>

#include "frame_filter/history.hpp"

namespace hmcdyn::internal {

/// The options with baselines in rising order.
/// @throws std::invalid_argument naming the first option out of range.
FrameFilterOptions checked(FrameFilterOptions options);

/// @throws std::invalid_argument for an image of the wrong type or size, or unequal arrays.
void checkFrame(const FrameInput& frame);

/// @throws std::invalid_argument for a mask beside boxes or of another size than the image.
void checkRegions(const FrameInput& frame, const Regions& regions);

/// The boxes, or those around a mask's regions; none where nobody said anything (null).
std::vector<DetectionBox> namedBoxes(const Regions* regions);

KeyPoints keyPointsOf(const FrameInput& frame);

DepthImageView viewOf(const cv::Mat& depth);

/// N pixels as arrays; empty = none.
struct Pixels {
  std::vector<float> u, v;
};
Pixels matchedPixelsOf(const FrameInput& frame);

/// Gives the caller's matches to the earlier frame that they are with, if it is among `frames`.
void giveMatches(const std::vector<const RememberedFrame*>& frames, double timestamp,
                 const Pixels& matched, std::vector<EarlierFrame>& earlier);

/// What becomes of a frame whose time stamp does not rise.
FrameFilterResult notCompared(const FrameInput& frame, std::vector<DetectionBox> boxes,
                              const FrameFilterOptions& options);

}  // namespace hmcdyn::internal

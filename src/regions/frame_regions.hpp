// SPDX-License-Identifier: BSD-3-Clause
// What may move in a frame: boxes, or the regions of a mask, and the key points of each.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <opencv2/core/types.hpp>

#include <hmcdyn/dynamic_feature_filter.hpp>
#include <hmcdyn/regions.hpp>
#include <hmcdyn/steps/box_dynamism.hpp>

namespace hmcdyn::internal {

struct FrameRegions {
  std::vector<DetectionBox> boxes;  ///< One a region: the detector's, or around the mask's pixels.
  BoxMembership membership;         ///< Of all N key points.
  bool by_mask = false;             ///< The mask says which point belongs where, not the boxes.
  std::vector<int> region;          ///< N regions of a mask; else empty.
};

/// @throws std::invalid_argument where boxes and labels are both given, or the labels are not of
/// the image's size or of another type than the masks'.
FrameRegions regionsOf(const DynamicFeatureFilterInput& input);

/// The membership of some of the key points. @param source their numbers. @param points the same.
/// @param reuse a result whose memory is taken over.
BoxMembership membershipOf(const FrameRegions& regions, const std::vector<std::size_t>& source,
                           const KeyPointsView& points, BoxMembership reuse = {});

/// N flags: the point belongs to a region.
std::vector<std::uint8_t> inRegion(const FrameRegions& regions, std::size_t points);

/// Part of the image that boxes cover, 0..1; what several cover counts once.
double shareCovered(Span<const DetectionBox> boxes, const cv::Size& image);

}  // namespace hmcdyn::internal

// SPDX-License-Identifier: BSD-3-Clause
// What the motion mask says about key points.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include <hmcdyn/dynamic_feature_filter.hpp>
#include <hmcdyn/frame_filter.hpp>
#include <hmcdyn/motion_mask.hpp>
#include <hmcdyn/span.hpp>
#include <hmcdyn/types.hpp>

namespace hmcdyn::internal {

/// Whether the frame has a depth image that is large enough for a mask.
bool canBeMasked(const FrameInput& frame);

/// The frame as the mask takes it; borrows its images, boxes and regions.
MotionMaskFrame maskFrameOf(const FrameInput& frame, const DynamicFeatureFilterInput& input,
                            const Eigen::Isometry3d& odometry, bool pose_is_known);

/// What the mask says at the nearest pixels of N points; unknown where it is worth nothing, and for
/// corners of the room's side of a silhouette, which move with what moves.
std::vector<MaskLabel> labelsAt(const KeyPointsView& points, const MotionMask& mask);

/// N flags: 1 where judgeByMask() leaves the word to the steps before. Empty = no mask.
std::vector<std::uint8_t> leftOpen(Span<const MaskLabel> seen);

/// Labels, weights and beliefs of the points about which the mask knows something: what moves is
/// dynamic, what is of the room static. Where it knows nothing, and of things that stand, the steps
/// before have the word, but nothing is called dynamic by their word alone: their distances are of
/// an image of corners at silhouettes, the mask's of surfaces.
/// @param result of the N points; its beliefs become the next frame's memory.
/// @param seen N labels; empty = no mask, and the result stays as it is.
DynamicFeatureFilterResult judgeByMask(DynamicFeatureFilterResult result,
                                       Span<const MaskLabel> seen,
                                       const MotionBeliefOptions& options);

}  // namespace hmcdyn::internal

// SPDX-License-Identifier: BSD-3-Clause
// What a FrameFilter keeps from frame to frame.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include <hmcdyn/dynamic_feature_filter.hpp>
#include <hmcdyn/frame_filter.hpp>
#include <hmcdyn/motion_mask.hpp>
#include <hmcdyn/span.hpp>
#include <hmcdyn/steps/box_carrier.hpp>

#include "frame_filter/history.hpp"

namespace hmcdyn {

struct FrameFilter::Memory {
  explicit Memory(FrameFilterOptions checked);

  /// The way of one frame. @param detected null = the detector has not answered.
  FrameFilterResult filter(const FrameInput& frame, const Regions* detected);

  /// The frame's boxes: what was detected, and what the carrier makes of it; of a mask those around
  /// its regions.
  std::vector<DetectionBox> boxesOf(const FrameInput& frame, const Regions* detected);

  /// The frames to compare with; none for a rule that compares nothing.
  std::vector<const internal::RememberedFrame*> framesBefore(double timestamp) const;

  /// Where the camera is likely to be: as the front end says, else as it moved before.
  std::optional<Eigen::Isometry3d> predict(const FrameInput& frame) const;

  /// What the frame's motion mask says of its points; empty where there is no mask.
  /// @param pose camera from world, if anybody knows. @param current gets its odometry.
  std::vector<MaskLabel> makeMask(const FrameInput& frame, const DynamicFeatureFilterInput& input,
                                  const std::optional<Eigen::Isometry3d>& pose,
                                  internal::RememberedFrame& current);

  void reset() noexcept;

  FrameFilterOptions options;
  DynamicFeatureFilterOptions steps;
  internal::FrameHistory history;
  std::optional<BoxCarrier> carrier;
  std::optional<MotionMaskEstimator> masks;
  const MotionMask* mask = nullptr;  ///< Of the last frame, if it has one.
  std::size_t frames = 0;            ///< That the carrier has seen.
  DynamicFeatureFilterWorkspace workspace;
};

}  // namespace hmcdyn

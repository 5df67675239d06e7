// SPDX-License-Identifier: BSD-3-Clause
#include "slam/run/filter_frame.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>

#include <hmcdyn/label_image.hpp>

namespace hmcdyn::slam {
namespace {

std::vector<std::uint8_t> flagPeople(const KeyPoints& points, const FrameMask& mask) {
  std::vector<std::uint8_t> in_person;
  in_person.reserve(points.size());
  for (const int region : regionsOfPoints(points.view(), mask.labels, mask.regions)) {
    const bool inside = region != kNoRegion &&
                        mask.regions[static_cast<std::size_t>(region)].class_id == kPersonClassId;
    in_person.push_back(inside ? 1 : 0);
  }
  return in_person;
}

std::vector<std::uint8_t> flagPeople(const KeyPoints& points, Span<const DetectionBox> boxes) {
  std::vector<std::uint8_t> in_person(points.size(), 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool inside = std::any_of(boxes.begin(), boxes.end(), [&](const DetectionBox& box) {
      return box.class_id == kPersonClassId && box.contains(points.u[i], points.v[i]);
    });
    in_person[i] = inside ? 1 : 0;
  }
  return in_person;
}

}  // namespace

FrameFilterResult filterFrame(const RgbdFrame& image, const std::vector<DetectionBox>& boxes,
                              const FrameMask& mask, const Tracker& tracker, FrameFilter& filter,
                              Frame& frame) {
  FrameInput input;
  input.timestamp = image.timestamp;
  input.gray = image.gray;
  input.depth = image.depth;
  input.key_points = frame.features.key_points;
  input.point_depth = frame.points.depth;
  if (const std::optional<MotionPrediction> expected = tracker.predict(image.timestamp)) {
    input.predicted_pose = Pose(expected->camera_from_world);
  }
  FrameFilterResult result =
      filter.filter(input, mask.empty() ? Regions(boxes) : Regions(mask.labels, mask.regions));
  frame.label = result.label;
  frame.weight = result.weight;
  frame.lambda = result.lambda;
  frame.soft_weights = result.soft_weights;
  if (result.camera_from_world) {
    frame.odometry = Eigen::Isometry3d(*result.camera_from_world);
  }
  if (filter.options().rule != FilterRule::kNone) {
    frame.in_person =
        mask.empty() ? flagPeople(frame.points, boxes) : flagPeople(frame.points, mask);
    for (std::size_t i = 0; i < result.mask.size(); ++i) {
      if (result.mask[i] == MaskLabel::kStatic) {  // background in a person's box
        frame.in_person[i] = 0;
      } else if (result.mask[i] == MaskLabel::kStanding) {  // somebody who paused, without a box
        frame.in_person[i] = 1;
      }
    }
  }
  return result;
}

}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
// The way of one frame, from top to bottom.
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <hmcdyn/frame_filter.hpp>
#include <hmcdyn/label_image.hpp>
#include <hmcdyn/motion_mask.hpp>

#include "frame_filter/decision.hpp"
#include "frame_filter/history.hpp"
#include "frame_filter/input.hpp"
#include "frame_filter/mask_verdict.hpp"
#include "regions/frame_regions.hpp"

namespace hmcdyn {

struct FrameFilter::Memory {
  explicit Memory(FrameFilterOptions checked)
      : options(std::move(checked)), steps(options.steps()), history(options.baselines) {
    BoxCarrierOptions carrying;
    carrying.max_bridge = options.bridge;
    carrying.duplicate_overlap = 1.0f;  // boxes are taken as they are
    if (options.bridge > 0.0) {
      carrier.emplace(carrying);
    }
    if (options.camera.fx > 0.0 && options.camera.fy > 0.0 && steps.use_belief &&
        options.rule == FilterRule::kHmc) {
      masks.emplace(options.camera);
    }
  }

  FrameFilterResult filter(const FrameInput& frame, std::vector<DetectionBox> boxes,
                           const RegionMask* regions);
  std::vector<DetectionBox> bridge(const FrameInput& frame,
                                   std::optional<Span<const DetectionBox>> detected);
  std::vector<MaskLabel> makeMask(const FrameInput& frame, const DynamicFeatureFilterInput& input,
                                  const std::optional<Eigen::Isometry3d>& pose,
                                  internal::RememberedFrame& current);

  FrameFilterOptions options;
  DynamicFeatureFilterOptions steps;
  internal::FrameHistory history;
  std::optional<BoxCarrier> carrier;
  std::optional<MotionMaskEstimator> masks;
  const MotionMask* mask = nullptr;  ///< Of the last frame, if it has one.
  std::size_t frames = 0;            ///< That the carrier has seen.
  DynamicFeatureFilterWorkspace workspace;
};

FrameFilter::FrameFilter(FrameFilterOptions options)
    : memory_(std::make_unique<Memory>(internal::checked(std::move(options)))) {}
FrameFilter::~FrameFilter() = default;
FrameFilter::FrameFilter(FrameFilter&& other) noexcept = default;
FrameFilter& FrameFilter::operator=(FrameFilter&& other) noexcept = default;

std::vector<DetectionBox> FrameFilter::Memory::bridge(
    const FrameInput& frame, std::optional<Span<const DetectionBox>> detected) {
  const std::size_t index = frames++;
  std::optional<FrameDetection> said;
  if (detected) {
    said = FrameDetection{index, {detected->begin(), detected->end()}};
  }
  if (carrier) {
    // The carrier keeps the depth image, and the caller's memory is the caller's.
    return carrier->update({index, frame.timestamp, frame.gray, frame.depth.clone()}, said);
  }
  return said ? std::move(said->boxes) : std::vector<DetectionBox>{};
}

/// What the frame's motion mask says of its points; empty where there is no mask.
/// @param pose camera from world, if anybody knows. @param current gets its odometry.
std::vector<MaskLabel> FrameFilter::Memory::makeMask(const FrameInput& frame,
                                                     const DynamicFeatureFilterInput& input,
                                                     const std::optional<Eigen::Isometry3d>& pose,
                                                     internal::RememberedFrame& current) {
  mask = nullptr;
  if (!masks || !internal::canBeMasked(frame)) {
    return {};
  }
  const std::optional<Eigen::Isometry3d> odometry = pose ? history.odometryOf(*pose) : std::nullopt;
  if (pose && !odometry) {
    masks->reset();  // from here on in a world of its own
  }
  current.odometry = odometry.value_or(Eigen::Isometry3d::Identity());
  mask = &masks->update(internal::maskFrameOf(frame, input, current.odometry, pose.has_value()));
  return internal::labelsAt(input.points, *mask);
}

FrameFilterResult FrameFilter::Memory::filter(const FrameInput& frame,
                                              std::vector<DetectionBox> boxes,
                                              const RegionMask* regions) {
  const std::size_t bridged = regions == nullptr && carrier ? carrier->bridged() : 0;
  const KeyPoints points = internal::keyPointsOf(frame);
  internal::RememberedFrame current;
  current.timestamp = frame.timestamp;
  current.pyramid = buildFlowPyramid(frame.gray, steps.flow);

  const bool compares = options.rule != FilterRule::kNone;
  const std::vector<const internal::RememberedFrame*> past =
      compares ? history.earlierThan(frame.timestamp)
               : std::vector<const internal::RememberedFrame*>{};
  std::optional<Eigen::Isometry3d> predicted;
  if (frame.predicted_pose) {
    predicted = Eigen::Isometry3d(*frame.predicted_pose);
  } else if (options.camera.fx > 0.0) {
    predicted = history.predict(frame.timestamp);
  }
  std::vector<EarlierFrame> earlier = internal::earlierFrames(past, frame.timestamp, predicted);
  const internal::Pixels matched = internal::matchedPixelsOf(frame);
  internal::giveMatches(past, frame.matched_timestamp, matched, earlier);

  DynamicFeatureFilterInput input;
  input.pyramid = &current.pyramid;
  input.points = points.view();
  input.earlier = earlier;
  input.camera = options.camera;
  input.depth = internal::viewOf(frame.depth);
  input.memory = past.empty() ? nullptr : &past.front()->belief;
  if (regions == nullptr) {
    input.boxes = boxes;
  } else {
    input.labels = regions->labels;
    input.regions = regions->regions;
  }
  const std::vector<std::uint8_t> in_region =
      internal::inRegion(internal::regionsOf(input), points.size());
  DynamicFeatureFilterResult details = filterDynamicFeatures(input, steps, workspace);
  current.camera_from_world = history.poseFrom(past, details.earlier);
  // A prediction is good enough for the mask, but nothing for later frames to go on from.
  std::vector<MaskLabel> seen = makeMask(
      frame, input, current.camera_from_world ? current.camera_from_world : predicted, current);
  details = internal::judgeByMask(std::move(details), seen, steps.belief);
  FrameFilterResult result =
      internal::decide(std::move(details), std::move(seen), in_region, options);

  if (compares && past.empty()) {
    result.status = FrameFilterStatus::kNoHistory;
    if (options.drop_boxes_without_history) {
      internal::dropRegions(in_region, result);
    }
  } else if (result.details.earlier.empty()) {
    result.status = FrameFilterStatus::kNothingToDo;
  } else if (result.details.camera_unknown) {
    result.status = FrameFilterStatus::kCameraUnknown;
  }
  if (current.camera_from_world && history.inCallersWorld()) {
    result.camera_from_world = Pose(*current.camera_from_world);
  }
  current.belief = result.details.belief;
  history.add(std::move(current));
  result.boxes =
      regions == nullptr ? std::move(boxes) : boundingBoxes(regions->labels, regions->regions);
  result.bridged = bridged;
  return internal::keepEnough(std::move(result), options);
}

FrameFilterResult FrameFilter::filter(const FrameInput& frame, Span<const DetectionBox> boxes) {
  internal::checkFrame(frame);
  memory_->history.checkSize(frame.gray.size());
  if (!memory_->history.follows(frame.timestamp)) {
    memory_->mask = nullptr;  // the one that is there is of another frame
    return internal::notCompared(frame, boxes, memory_->options);
  }
  return memory_->filter(frame, memory_->bridge(frame, boxes), nullptr);
}

FrameFilterResult FrameFilter::filter(const FrameInput& frame) {
  internal::checkFrame(frame);
  memory_->history.checkSize(frame.gray.size());
  if (!memory_->history.follows(frame.timestamp)) {
    memory_->mask = nullptr;  // the one that is there is of another frame
    return internal::notCompared(frame, {}, memory_->options);
  }
  return memory_->filter(frame, memory_->bridge(frame, std::nullopt), nullptr);
}

FrameFilterResult FrameFilter::filter(const FrameInput& frame, const RegionMask& mask) {
  internal::checkFrame(frame);
  memory_->history.checkSize(frame.gray.size());
  internal::checkMask(frame, mask);
  if (!memory_->history.follows(frame.timestamp)) {
    memory_->mask = nullptr;  // the one that is there is of another frame
    return internal::notCompared(frame, boundingBoxes(mask.labels, mask.regions), memory_->options);
  }
  return memory_->filter(frame, {}, &mask);
}

void FrameFilter::setPose(double timestamp, const Pose& camera_from_world) {
  const std::optional<Eigen::Isometry3d> odometry =
      memory_->history.setPose(timestamp, camera_from_world);
  if (odometry && memory_->masks) {
    memory_->masks->setPose(timestamp, Pose(*odometry));
  }
}

void FrameFilter::reset() noexcept {
  memory_->history.clear();
  memory_->mask = nullptr;
  if (memory_->carrier) {
    memory_->carrier->reset();
  }
  if (memory_->masks) {
    memory_->masks->reset();
  }
}

const MotionMask* FrameFilter::mask() const noexcept { return memory_->mask; }

const FrameFilterOptions& FrameFilter::options() const noexcept { return memory_->options; }

}  // namespace hmcdyn

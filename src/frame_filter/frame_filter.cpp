// SPDX-License-Identifier: BSD-3-Clause
// The way of one frame, from top to bottom.
#include <utility>

#include <hmcdyn/frame_filter.hpp>
#include <hmcdyn/label_image.hpp>

#include "frame_filter/decision.hpp"
#include "frame_filter/filter_steps.hpp"
#include "frame_filter/history.hpp"
#include "frame_filter/input.hpp"
#include "frame_filter/mask_verdict.hpp"
#include "frame_filter/memory.hpp"
#include "regions/frame_regions.hpp"

namespace hmcdyn {

FrameFilterResult FrameFilter::Memory::filter(const FrameInput& frame, const Regions* detected) {
  internal::checkFrame(frame);
  history.checkSize(frame.gray.size());
  if (detected != nullptr) {
    internal::checkRegions(frame, *detected);
  }
  if (!history.follows(frame.timestamp)) {
    mask = nullptr;  // the one that is there is of another frame
    return internal::notCompared(frame, internal::namedBoxes(detected), options);
  }

  // What came in, and what it is compared with.
  const bool by_mask = detected != nullptr && detected->byMask();
  std::vector<DetectionBox> boxes = boxesOf(frame, detected);
  const KeyPoints points = internal::keyPointsOf(frame);
  internal::RememberedFrame current;
  current.timestamp = frame.timestamp;
  current.pyramid = buildFlowPyramid(frame.gray, steps.flow, history.takeSpare());
  const std::vector<const internal::RememberedFrame*> past = framesBefore(frame.timestamp);
  const std::optional<Eigen::Isometry3d> predicted = predict(frame);
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
  input.regions = by_mask ? *detected : Regions(boxes);
  internal::checkInput(input, steps);
  const internal::FrameRegions places = internal::regionsOf(input);
  const std::vector<std::uint8_t> in_region = internal::inRegion(places, points.size());

  // The points by their own distances; surfaces by the mask, as the camera is known now; what is
  // left open, by the votes of its neighbours.
  DynamicFeatureFilterResult details =
      internal::judgeByDistance(input, places, in_region, steps, workspace);
  current.camera_from_world = history.poseFrom(past, details.earlier);
  // A prediction is good enough for the mask, but nothing for later frames to go on from.
  std::vector<MaskLabel> seen = makeMask(
      frame, input, current.camera_from_world ? current.camera_from_world : predicted, current);
  details = internal::judgeByBelief(std::move(details), input, in_region, internal::leftOpen(seen),
                                    steps, workspace);
  details = internal::judgeByMask(std::move(details), seen, steps.belief);
  FrameFilterResult result =
      internal::decide(std::move(details), std::move(seen), in_region, options);

  // What the front end is told besides, and what is kept for the next frame.
  result.status = internal::statusOf(result.details, options.rule, past.empty());
  if (result.status == FrameFilterStatus::kNoHistory && options.drop_boxes_without_history) {
    internal::dropRegions(in_region, result);
  }
  if (current.camera_from_world && history.inCallersWorld()) {
    result.camera_from_world = Pose(*current.camera_from_world);
  }
  current.belief = result.details.belief;
  history.add(std::move(current));
  result.bridged = !by_mask && carrier ? carrier->bridged() : 0;
  result.boxes = std::move(boxes);
  return internal::keepEnough(std::move(result), options);
}

FrameFilter::FrameFilter(FrameFilterOptions options)
    : memory_(std::make_unique<Memory>(internal::checked(std::move(options)))) {}
FrameFilter::~FrameFilter() = default;
FrameFilter::FrameFilter(FrameFilter&& other) noexcept = default;
FrameFilter& FrameFilter::operator=(FrameFilter&& other) noexcept = default;

FrameFilterResult FrameFilter::filter(const FrameInput& frame, const Regions& regions) {
  return memory_->filter(frame, &regions);
}

FrameFilterResult FrameFilter::filter(const FrameInput& frame) {
  return memory_->filter(frame, nullptr);
}

void FrameFilter::setPose(double timestamp, const Pose& camera_from_world) {
  const std::optional<Eigen::Isometry3d> odometry =
      memory_->history.setPose(timestamp, camera_from_world);
  if (odometry && memory_->masks) {
    memory_->masks->setPose(timestamp, Pose(*odometry));
  }
}

void FrameFilter::reset() noexcept { memory_->reset(); }

const MotionMask* FrameFilter::mask() const noexcept { return memory_->mask; }

const FrameFilterOptions& FrameFilter::options() const noexcept { return memory_->options; }

}  // namespace hmcdyn

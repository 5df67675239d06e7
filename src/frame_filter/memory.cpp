// SPDX-License-Identifier: BSD-3-Clause
#include "frame_filter/memory.hpp"

#include <utility>

#include "frame_filter/input.hpp"
#include "frame_filter/mask_verdict.hpp"

namespace hmcdyn {

FrameFilter::Memory::Memory(FrameFilterOptions checked)
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

std::vector<DetectionBox> FrameFilter::Memory::boxesOf(const FrameInput& frame,
                                                       const Regions* detected) {
  std::vector<DetectionBox> boxes = internal::namedBoxes(detected);
  if (detected != nullptr && detected->byMask()) {
    return boxes;
  }
  const std::size_t index = frames++;
  if (!carrier) {
    return boxes;
  }
  std::optional<FrameDetection> said;
  if (detected != nullptr) {
    said = FrameDetection{index, std::move(boxes)};
  }
  // The carrier keeps the depth image, and the caller's memory is the caller's.
  return carrier->update({index, frame.timestamp, frame.gray, frame.depth.clone()}, said);
}

std::vector<const internal::RememberedFrame*> FrameFilter::Memory::framesBefore(
    double timestamp) const {
  return options.rule == FilterRule::kNone ? std::vector<const internal::RememberedFrame*>{}
                                           : history.earlierThan(timestamp);
}

std::optional<Eigen::Isometry3d> FrameFilter::Memory::predict(const FrameInput& frame) const {
  if (frame.predicted_pose) {
    return Eigen::Isometry3d(*frame.predicted_pose);
  }
  return options.camera.fx > 0.0 ? history.predict(frame.timestamp) : std::nullopt;
}

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

void FrameFilter::Memory::reset() noexcept {
  history.clear();
  mask = nullptr;
  if (carrier) {
    carrier->reset();
  }
  if (masks) {
    masks->reset();
  }
}

}  // namespace hmcdyn

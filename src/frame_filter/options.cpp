// SPDX-License-Identifier: BSD-3-Clause
#include <limits>
#include <utility>

#include <hmcdyn/frame_filter.hpp>

namespace hmcdyn {

FrameFilterOptions FrameFilterOptions::paper() {
  FrameFilterOptions options;
  options.baselines = {0.0};
  options.bridge = 0.0;
  options.drop_boxes_without_history = false;
  options.min_kept = 0;
  options.max_followed = 0;
  DynamicFeatureFilterOptions& filter = options.expert;
  filter.use_belief = false;
  // Flow and F as exact as before time was saved on them: without a mask all hangs on them.
  filter.flow.epsilon = 0.01f;
  filter.two_view.max_iterations = 2000;
  // F from all matches, and always F: no background first, no homography, no camera that stood.
  filter.two_view.min_background_matches = std::numeric_limits<int>::max();
  filter.two_view.still_displacement = 0.0f;
  filter.two_view.min_conditioning = 1.0f;
  filter.require_known_camera = false;
  filter.max_median_distance = std::numeric_limits<float>::infinity();
  filter.stage.cluster_filter.min_strongest_distance = 0.0f;
  filter.stage.cluster_filter.screening_ratio = 1.0f;
  filter.stage.cluster_filter.screening_floor = 0.0f;
  filter.stage.cluster_filter.place_unmatched_by_depth = false;
  return options;
}

DynamicFeatureFilterOptions FrameFilterOptions::steps() const {
  DynamicFeatureFilterOptions steps = expert;
  steps.stage.rule = rule;
  steps.two_view.seed = seed;
  steps.stage.depth_ransac.seed = seed;
  // Most of a frame's background says the same; of those in boxes each may move on its own.
  steps.flow_in_boxes = max_followed * 5 / 9;
  steps.flow_background = max_followed - steps.flow_in_boxes;
  return steps;
}

FrameFilterOptions without(Ablation ablation, FrameFilterOptions options) {
  switch (ablation) {
    case Ablation::kNone:
      break;
    case Ablation::kRs:
      options.rule = FilterRule::kDynamicBox;
      break;
    case Ablation::kDf:
      options.rule = FilterRule::kEpipolar;
      break;
    case Ablation::kOpw:
      options.soft_weight_gate = 1.0;
      break;
  }
  return options;
}

const char* toString(Ablation ablation) noexcept {
  switch (ablation) {
    case Ablation::kNone:
      return "none";
    case Ablation::kRs:
      return "rs";
    case Ablation::kDf:
      return "df";
    case Ablation::kOpw:
      return "opw";
  }
  return "invalid";
}

const char* toString(FrameFilterStatus status) noexcept {
  switch (status) {
    case FrameFilterStatus::kFiltered:
      return "filtered";
    case FrameFilterStatus::kNothingToDo:
      return "nothing to do";
    case FrameFilterStatus::kNoHistory:
      return "no history";
    case FrameFilterStatus::kCameraUnknown:
      return "camera unknown";
    case FrameFilterStatus::kStampNotRising:
      return "time stamp does not rise";
  }
  return "invalid";
}

const char* toString(PointReason reason) noexcept {
  switch (reason) {
    case PointReason::kOutside:
      return "outside";
    case PointReason::kAtRest:
      return "at rest";
    case PointReason::kApart:
      return "apart";
    case PointReason::kMoves:
      return "moves";
    case PointReason::kMovesAlong:
      return "moves along";
    case PointReason::kRoom:
      return "room";
    case PointReason::kMask:
      return "mask";
    case PointReason::kNoHistory:
      return "no history";
    case PointReason::kForNumber:
      return "for number";
  }
  return "invalid";
}

}  // namespace hmcdyn

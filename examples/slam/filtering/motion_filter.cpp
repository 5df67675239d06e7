// SPDX-License-Identifier: BSD-3-Clause
#include "slam/filtering/motion_filter.hpp"

#include <algorithm>
#include <utility>

#include <hmcdyn/label_image.hpp>
#include <hmcdyn/weights.hpp>

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

MotionFilter::MotionFilter(MotionFilterOptions options) : options_(std::move(options)) {}

std::vector<EarlierFrame> MotionFilter::selectEarlier(double timestamp) const {
  std::vector<EarlierFrame> earlier;
  const Remembered* last = nullptr;
  for (const double baseline : options_.baselines) {
    const auto youngest = std::find_if(
        history_.rbegin(), history_.rend(),
        [&](const Remembered& frame) { return timestamp - frame.timestamp >= baseline; });
    if (youngest == history_.rend() || &*youngest == last) {
      continue;
    }
    last = &*youngest;
    EarlierFrame frame;
    frame.pyramid = &youngest->pyramid;
    frame.age = timestamp - youngest->timestamp;
    earlier.push_back(frame);
  }
  return earlier;
}

void MotionFilter::forgetBefore(double timestamp) {
  while (!history_.empty() && history_.front().timestamp < timestamp) {
    history_.pop_front();
  }
}

DynamicFeatureFilterResult MotionFilter::filter(const cv::Mat& gray, const cv::Mat& depth,
                                                Span<const DetectionBox> boxes, Frame& frame,
                                                const FrameMask& mask) {
  Remembered current{frame.timestamp, buildFlowPyramid(gray, options_.filter.flow)};
  const std::vector<EarlierFrame> earlier = options_.filter.stage.rule == FilterRule::kNone
                                                ? std::vector<EarlierFrame>{}
                                                : selectEarlier(frame.timestamp);
  DynamicFeatureFilterInput input;
  input.pyramid = &current.pyramid;
  input.points = frame.points.view();
  if (mask.empty()) {
    input.boxes = boxes;
  } else {
    input.labels = mask.labels;
    input.regions = mask.regions;
  }
  input.earlier = earlier;
  input.depth = {depth.ptr<float>(), depth.cols, depth.rows, depth.step1()};
  // A memory is of the frame before: it needs the flow to that one, which the baselines may leave
  // out.
  const bool has_neighbour =
      !earlier.empty() && earlier.front().pyramid == &history_.back().pyramid;
  input.memory = has_neighbour ? &memory_ : nullptr;
  DynamicFeatureFilterResult result = filterDynamicFeatures(input, options_.filter, workspace_);
  memory_ = result.belief;

  const FrameDecision& decision = result.stage.frame;
  frame.label = result.stage.label;
  if (options_.filter.stage.rule != FilterRule::kNone) {
    frame.in_person =
        mask.empty() ? flagPeople(frame.points, boxes) : flagPeople(frame.points, mask);
  }
  frame.soft_weights =
      options_.soft_weights &&
      useSoftWeights(decision.points_in_dynamic_boxes, decision.points, options_.soft_weight_gate);
  frame.weight = frame.soft_weights ? result.stage.weight
                                    : hardWeights(Span<const float>(result.stage.weight));

  const double longest = options_.baselines.empty() ? 0.0
                                                    : *std::max_element(options_.baselines.begin(),
                                                                        options_.baselines.end());
  constexpr double kSpare = 0.5;  // s: a late frame must still find one that is old enough
  forgetBefore(frame.timestamp - longest - kSpare);
  history_.push_back(std::move(current));
  return result;
}

}  // namespace hmcdyn::slam

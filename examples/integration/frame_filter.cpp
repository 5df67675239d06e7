// SPDX-License-Identifier: BSD-3-Clause
#include "integration/frame_filter.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include <hmcdyn/weights.hpp>

namespace hmcdyn::integration {
namespace {

std::string sizeText(const cv::Mat& image) {
  return std::to_string(image.cols) + " x " + std::to_string(image.rows) + " px, " +
         cv::typeToString(image.type());
}

/// The nearest pixel's depth; 0 outside the image and for points that are not finite.
float depthAt(const cv::Mat& depth, const cv::Point2f& point) {
  const float column = std::floor(point.x + 0.5f);
  const float row = std::floor(point.y + 0.5f);
  const bool inside = column >= 0.0f && row >= 0.0f && column < static_cast<float>(depth.cols) &&
                      row < static_cast<float>(depth.rows);
  return inside ? depth.at<float>(static_cast<int>(row), static_cast<int>(column)) : 0.0f;
}

KeyPoints pointsOf(const FrameInput& frame) {
  KeyPoints points;
  points.reserve(frame.key_points.size());
  for (std::size_t i = 0; i < frame.key_points.size(); ++i) {
    const cv::Point2f& pixel = frame.key_points[i].pt;
    points.push_back(
        pixel.x, pixel.y,
        frame.point_depth.empty() ? depthAt(frame.depth, pixel) : frame.point_depth[i]);
  }
  return points;
}

DepthImageView viewOf(const cv::Mat& depth) {
  return depth.empty() ? DepthImageView{}
                       : DepthImageView{depth.ptr<float>(), depth.cols, depth.rows, depth.step1()};
}

}  // namespace

FrameFilter::FrameFilter(FrameFilterOptions options) : options_(std::move(options)) {
  for (const double baseline : options_.baselines) {
    if (!(baseline >= 0.0 && std::isfinite(baseline))) {
      throw std::invalid_argument("FrameFilterOptions::baselines holds " +
                                  std::to_string(baseline) + "; expected ages >= 0 (s)");
    }
  }
  std::sort(options_.baselines.begin(), options_.baselines.end());
}

void FrameFilter::checkFrame(const FrameInput& frame) const {
  const bool later = history_.empty() || frame.timestamp > history_.back().timestamp;
  if (!later || !std::isfinite(frame.timestamp)) {
    throw std::invalid_argument(
        "FrameFilter: timestamp is " + std::to_string(frame.timestamp) + " s" +
        (history_.empty() ? std::string("; expected a finite time")
                          : ", after " + std::to_string(history_.back().timestamp) +
                                " s; expected a later one, or reset() before"));
  }
  if (!frame.depth.empty() &&
      (frame.depth.type() != CV_32FC1 || frame.depth.size() != frame.gray.size())) {
    throw std::invalid_argument("FrameFilter: depth is " + sizeText(frame.depth) +
                                "; expected CV_32FC1 (m) of the image's size, " +
                                std::to_string(frame.gray.cols) + " x " +
                                std::to_string(frame.gray.rows) + " px");
  }
  if (!frame.point_depth.empty() && frame.point_depth.size() != frame.key_points.size()) {
    throw std::invalid_argument("FrameFilter: " + std::to_string(frame.key_points.size()) +
                                " key points, but " + std::to_string(frame.point_depth.size()) +
                                " depths; expected equal sizes, or none");
  }
}

FrameFilter::Prepared FrameFilter::prepare(const FrameInput& frame) const {
  checkFrame(frame);
  Prepared prepared;
  prepared.current.timestamp = frame.timestamp;
  prepared.current.pyramid = buildFlowPyramid(frame.gray, options_.filter.flow);
  prepared.points = pointsOf(frame);
  if (options_.filter.stage.rule == FilterRule::kNone) {
    return prepared;
  }
  for (const double baseline : options_.baselines) {
    const auto youngest = std::find_if(
        history_.rbegin(), history_.rend(),
        [&](const Remembered& past) { return frame.timestamp - past.timestamp >= baseline; });
    if (youngest == history_.rend() ||
        (!prepared.earlier.empty() && prepared.earlier.back().pyramid == &youngest->pyramid)) {
      continue;
    }
    EarlierFrame earlier;
    earlier.pyramid = &youngest->pyramid;
    earlier.age = frame.timestamp - youngest->timestamp;
    prepared.earlier.push_back(earlier);
    prepared.memory = prepared.memory == nullptr ? &youngest->belief : prepared.memory;
  }
  return prepared;
}

DynamicFeatureFilterInput FrameFilter::inputOf(const Prepared& prepared, const cv::Mat& depth) {
  DynamicFeatureFilterInput input;
  input.pyramid = &prepared.current.pyramid;
  input.points = prepared.points.view();
  input.earlier = prepared.earlier;
  input.depth = viewOf(depth);
  input.memory = prepared.memory;
  return input;
}

FrameFilterResult FrameFilter::finish(DynamicFeatureFilterResult details, Remembered current) {
  FrameFilterResult result;
  const FrameDecision& decision = details.stage.frame;
  result.soft_weights =
      options_.soft_weights &&
      useSoftWeights(decision.points_in_dynamic_boxes, decision.points, options_.soft_weight_gate);
  result.weight = result.soft_weights ? details.stage.weight
                                      : hardWeights(Span<const float>(details.stage.weight));
  result.keep.resize(result.weight.size());
  std::transform(result.weight.begin(), result.weight.end(), result.keep.begin(),
                 [](float weight) { return static_cast<std::uint8_t>(weight > 0.0f ? 1 : 0); });
  current.belief = details.belief;
  result.details = std::move(details);

  const double longest = options_.baselines.empty() ? 0.0
                                                    : *std::max_element(options_.baselines.begin(),
                                                                        options_.baselines.end());
  constexpr double kSpare = 0.5;  // s: a late frame must still find one that is old enough
  while (!history_.empty() && history_.front().timestamp < current.timestamp - longest - kSpare) {
    history_.pop_front();
  }
  history_.push_back(std::move(current));
  return result;
}

FrameFilterResult FrameFilter::filter(const FrameInput& frame, Span<const DetectionBox> boxes) {
  Prepared prepared = prepare(frame);
  DynamicFeatureFilterInput input = inputOf(prepared, frame.depth);
  input.boxes = boxes;
  DynamicFeatureFilterResult details = filterDynamicFeatures(input, options_.filter, workspace_);
  return finish(std::move(details), std::move(prepared.current));
}

FrameFilterResult FrameFilter::filter(const FrameInput& frame, const RegionMask& mask) {
  if (mask.labels.size() != frame.gray.size()) {
    throw std::invalid_argument("FrameFilter: labels is " + sizeText(mask.labels) +
                                "; expected the image's size, " + std::to_string(frame.gray.cols) +
                                " x " + std::to_string(frame.gray.rows) + " px");
  }
  Prepared prepared = prepare(frame);
  DynamicFeatureFilterInput input = inputOf(prepared, frame.depth);
  input.labels = mask.labels;
  input.regions = mask.regions;
  DynamicFeatureFilterResult details = filterDynamicFeatures(input, options_.filter, workspace_);
  return finish(std::move(details), std::move(prepared.current));
}

void FrameFilter::reset() noexcept { history_.clear(); }

}  // namespace hmcdyn::integration

// SPDX-License-Identifier: BSD-3-Clause
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include <hmcdyn/dynamic_feature_filter.hpp>

#include "frame_filter/filter_steps.hpp"
#include "regions/frame_regions.hpp"

namespace hmcdyn {
namespace internal {
void checkInput(const DynamicFeatureFilterInput& input,
                const DynamicFeatureFilterOptions& options) {
  if (input.pyramid == nullptr) {
    throw std::invalid_argument("filterDynamicFeatures: pyramid of the current frame is null");
  }
  if (options.flow_background < 0 || options.flow_in_boxes < 0 || !(options.flow_margin >= 0.0f)) {
    throw std::invalid_argument("DynamicFeatureFilterOptions: flow_background is " +
                                std::to_string(options.flow_background) + ", flow_in_boxes " +
                                std::to_string(options.flow_in_boxes) + ", flow_margin " +
                                std::to_string(options.flow_margin) +
                                "; expected counts and a margin (px) >= 0");
  }
  const cv::Size image = input.pyramid->empty() ? cv::Size() : input.pyramid->front().size();
  const bool depth_fits = input.depth.width == image.width && input.depth.height == image.height;
  if (!input.depth.empty() && !input.pyramid->empty() && !depth_fits) {
    throw std::invalid_argument("filterDynamicFeatures: depth is " +
                                std::to_string(input.depth.width) + " x " +
                                std::to_string(input.depth.height) + " px; expected the image's " +
                                std::to_string(image.width) + " x " + std::to_string(image.height));
  }
  for (const EarlierFrame& frame : input.earlier) {
    if (frame.pyramid == nullptr) {
      throw std::invalid_argument("filterDynamicFeatures: pyramid of an earlier frame is null");
    }
    if (frame.pyramid->empty() || input.pyramid->empty() ||
        frame.pyramid->front().size() != input.pyramid->front().size()) {
      throw std::invalid_argument(
          "filterDynamicFeatures: expected pyramids of one image size, as buildFlowPyramid makes");
    }
    const std::size_t matched = frame.matched_u.size();
    if (frame.matched_v.size() != matched || (matched != 0 && matched != input.points.size())) {
      throw std::invalid_argument("filterDynamicFeatures: matched_u has " +
                                  std::to_string(matched) + " elements, matched_v " +
                                  std::to_string(frame.matched_v.size()) +
                                  "; expected none, or one for each of the " +
                                  std::to_string(input.points.size()) + " key points");
    }
    if (options.distance == DistanceKind::kTwoView) {
      continue;
    }
    const bool has_depth =
        frame.depth.type() == CV_32FC1 && !frame.depth.empty() &&
        (frame.pyramid->empty() || frame.depth.size() == frame.pyramid->front().size());
    if (!frame.current_from_earlier || !has_depth) {
      throw std::invalid_argument(
          "filterDynamicFeatures: the ego-motion distance needs current_from_earlier and depth "
          "(CV_32FC1, m, of the image's size) of every earlier frame");
    }
    if (!(input.camera.fx > 0.0 && input.camera.fy > 0.0)) {
      throw std::invalid_argument(
          "filterDynamicFeatures: the ego-motion distance needs a camera with fx, fy > 0");
    }
  }
}

}  // namespace internal

DynamicFeatureFilterResult filterDynamicFeatures(const DynamicFeatureFilterInput& input,
                                                 const DynamicFeatureFilterOptions& options,
                                                 DynamicFeatureFilterWorkspace& workspace) {
  internal::checkInput(input, options);
  const internal::FrameRegions regions = internal::regionsOf(input);
  const std::vector<std::uint8_t> in_region = internal::inRegion(regions, input.points.size());
  DynamicFeatureFilterResult result =
      internal::judgeByDistance(input, regions, in_region, options, workspace);
  return internal::judgeByBelief(std::move(result), input, in_region, {}, options, workspace);
}

namespace {

/// @param input without images.
DynamicFeatureFilterResult filterTwoImages(const cv::Mat& earlier_gray, const cv::Mat& current_gray,
                                           DynamicFeatureFilterInput input,
                                           const DynamicFeatureFilterOptions& options) {
  const FlowPyramid earlier = buildFlowPyramid(earlier_gray, options.flow);
  const FlowPyramid current = buildFlowPyramid(current_gray, options.flow);
  EarlierFrame frame;
  frame.pyramid = &earlier;
  input.pyramid = &current;
  input.earlier = Span<const EarlierFrame>(&frame, 1);
  DynamicFeatureFilterWorkspace workspace;
  return filterDynamicFeatures(input, options, workspace);
}

}  // namespace

DynamicFeatureFilterResult filterDynamicFeatures(const cv::Mat& earlier_gray,
                                                 const cv::Mat& current_gray,
                                                 const KeyPointsView& points,
                                                 Span<const DetectionBox> boxes,
                                                 const DynamicFeatureFilterOptions& options) {
  DynamicFeatureFilterInput input;
  input.points = points;
  input.regions = boxes;
  return filterTwoImages(earlier_gray, current_gray, input, options);
}

DynamicFeatureFilterResult filterDynamicFeatures(const cv::Mat& earlier_gray,
                                                 const cv::Mat& current_gray,
                                                 const KeyPointsView& points, const cv::Mat& labels,
                                                 Span<const LabelRegion> regions,
                                                 const DynamicFeatureFilterOptions& options) {
  if (labels.empty()) {
    throw std::invalid_argument("filterDynamicFeatures: labels is empty; expected a label image");
  }
  DynamicFeatureFilterInput input;
  input.points = points;
  input.regions = Regions(labels, regions);
  return filterTwoImages(earlier_gray, current_gray, input, options);
}

}  // namespace hmcdyn

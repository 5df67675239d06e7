// SPDX-License-Identifier: BSD-3-Clause
#include <cstdint>
#include <stdexcept>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include <hmcdyn/dynamic_feature_filter.hpp>

#include "frame_filter/filter_steps.hpp"
#include "regions/frame_regions.hpp"

namespace hmcdyn {

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

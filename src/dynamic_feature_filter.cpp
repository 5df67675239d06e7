// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include <opencv2/core.hpp>

#include <hmcdyn/dynamic_feature_filter.hpp>

namespace hmcdyn {
namespace {

void checkInput(const DynamicFeatureFilterInput& input,
                const DynamicFeatureFilterOptions& options) {
  if (input.pyramid == nullptr) {
    throw std::invalid_argument("filterDynamicFeatures: pyramid of the current frame is null");
  }
  for (const EarlierFrame& frame : input.earlier) {
    if (frame.pyramid == nullptr) {
      throw std::invalid_argument("filterDynamicFeatures: pyramid of an earlier frame is null");
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

/// Depth at the nearest pixel; 0 outside the image.
float depthAt(const cv::Mat& depth, float u, float v) {
  if (std::isnan(u) || std::isnan(v)) {
    return 0.0f;
  }
  const int column = cvRound(u);
  const int row = cvRound(v);
  const bool inside = column >= 0 && row >= 0 && column < depth.cols && row < depth.rows;
  return inside ? depth.at<float>(row, column) : 0.0f;
}

std::vector<float> egoMotionDistancesTo(const EarlierFrame& frame, const PointPairsView& pairs,
                                        const DynamicFeatureFilterInput& input,
                                        const EgoMotionOptions& options) {
  std::vector<float> earlier_depth(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    earlier_depth[i] = depthAt(frame.depth, pairs.earlier_u[i], pairs.earlier_v[i]);
  }
  return egoMotionDistances(input.camera, *frame.current_from_earlier, pairs, earlier_depth,
                            input.points.depth, options);
}

/// The larger distance; the other where one is NaN.
void keepLarger(const std::vector<float>& candidate, std::vector<float>& distance) {
  for (std::size_t i = 0; i < distance.size(); ++i) {
    distance[i] = std::fmax(distance[i], candidate[i]);
  }
}

}  // namespace

DynamicFeatureFilterResult filterDynamicFeatures(const DynamicFeatureFilterInput& input,
                                                 const DynamicFeatureFilterOptions& options,
                                                 DynamicFeatureFilterWorkspace& workspace) {
  checkInput(input, options);
  checkKeyPoints(input.points);
  DynamicFeatureFilterResult result;
  result.distance.assign(input.points.size(), kNaN);
  for (const EarlierFrame& frame : input.earlier) {
    const FlowMatches matches =
        trackIntoEarlierFrame(*input.pyramid, *frame.pyramid, input.points, options.flow);
    const PointPairsView pairs{matches.u, matches.v, input.points.u, input.points.v};

    EarlierFrameReport report;
    report.matches = matches.found;
    if (options.distance != DistanceKind::kEgoMotion) {
      report.motion = estimateMotionModel(pairs, input.boxes, options.motion);
      report.used = report.motion.model.kind != TwoViewModelKind::kNone &&
                    report.motion.median_distance <= options.max_median_distance;
      if (report.used) {
        workspace.distance =
            modelDistances(report.motion.model, pairs, std::move(workspace.distance));
        keepLarger(workspace.distance, result.distance);
      }
    }
    if (options.distance != DistanceKind::kTwoView) {
      report.used = true;
      keepLarger(egoMotionDistancesTo(frame, pairs, input, options.ego_motion), result.distance);
    }
    result.earlier.push_back(report);
  }
  result.stage =
      filterKeyPoints(input.points, result.distance, input.boxes, options.stage, workspace.stage);
  return result;
}

DynamicFeatureFilterResult filterDynamicFeatures(const cv::Mat& earlier_gray,
                                                 const cv::Mat& current_gray,
                                                 const KeyPointsView& points,
                                                 Span<const DetectionBox> boxes,
                                                 const DynamicFeatureFilterOptions& options) {
  const FlowPyramid earlier = buildFlowPyramid(earlier_gray, options.flow);
  const FlowPyramid current = buildFlowPyramid(current_gray, options.flow);
  EarlierFrame frame;
  frame.pyramid = &earlier;
  DynamicFeatureFilterInput input;
  input.pyramid = &current;
  input.points = points;
  input.boxes = boxes;
  input.earlier = Span<const EarlierFrame>(&frame, 1);
  DynamicFeatureFilterWorkspace workspace;
  return filterDynamicFeatures(input, options, workspace);
}

}  // namespace hmcdyn

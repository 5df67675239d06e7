// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include <hmcdyn/dynamic_feature_filter.hpp>

namespace hmcdyn {
namespace {

void checkInput(const DynamicFeatureFilterInput& input,
                const DynamicFeatureFilterOptions& options) {
  if (input.pyramid == nullptr) {
    throw std::invalid_argument("filterDynamicFeatures: pyramid of the current frame is null");
  }
  if (options.flow_background < 0 || !(options.flow_margin >= 0.0f)) {
    throw std::invalid_argument("DynamicFeatureFilterOptions: flow_background is " +
                                std::to_string(options.flow_background) + ", flow_margin " +
                                std::to_string(options.flow_margin) +
                                "; expected a count and a margin (px) >= 0");
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

bool inAnyBox(Span<const DetectionBox> boxes, float u, float v, float margin) {
  return std::any_of(boxes.begin(), boxes.end(), [&](const DetectionBox& box) {
    return u >= box.x_min - margin && u <= box.x_max + margin && v >= box.y_min - margin &&
           v <= box.y_max + margin;
  });
}

/// Whether distances are wanted: without a box, only what moved before can be dynamic.
bool distancesWanted(const DynamicFeatureFilterInput& input,
                     const DynamicFeatureFilterOptions& options) {
  return options.flow_background == 0 || !input.boxes.empty() ||
         (input.memory != nullptr &&
          std::any_of(input.memory->belief.begin(), input.memory->belief.end(),
                      [](float belief) { return belief > 0.0f; }));
}

/// The key points that get a distance, as arrays of their own.
struct FlowSelection {
  std::vector<std::size_t> source;  ///< Their numbers.
  KeyPoints points;
};

/// Cell of a grid over the image, for spreading points: up to kCells a side.
std::size_t cellOf(float u, float v, const cv::Size& size) {
  constexpr float kCells = 12.0f;
  const auto cell = [](float x, int extent) {
    return std::clamp(x / static_cast<float>(extent) * kCells, 0.0f, kCells - 1.0f);
  };
  return static_cast<std::size_t>(cell(v, size.height)) * static_cast<std::size_t>(kCells) +
         static_cast<std::size_t>(cell(u, size.width));
}

FlowSelection selectForFlow(const DynamicFeatureFilterInput& input,
                            const DynamicFeatureFilterOptions& options) {
  const KeyPointsView& points = input.points;
  const cv::Size size = input.pyramid->empty() ? cv::Size(1, 1) : input.pyramid->front().size();
  std::vector<std::uint8_t> chosen(points.size(), 0);
  std::vector<std::size_t> others;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (options.flow_background == 0 ||
        inAnyBox(input.boxes, points.u[i], points.v[i], options.flow_margin)) {
      chosen[i] = 1;
    } else if (std::isfinite(points.u[i]) && std::isfinite(points.v[i])) {
      others.push_back(i);
    }
  }
  // Round by round one more of each cell, in the order of the points, until there are enough.
  const auto wanted = static_cast<std::size_t>(options.flow_background);
  std::size_t count = 0;
  for (std::uint32_t round = 1; count < wanted && !others.empty(); ++round) {
    std::array<std::uint32_t, 144> taken{};
    std::vector<std::size_t> left;
    for (const std::size_t i : others) {
      std::uint32_t& in_cell = taken[cellOf(points.u[i], points.v[i], size)];
      if (in_cell == 0 && count < wanted) {
        ++in_cell;
        ++count;
        chosen[i] = 1;
      } else {
        left.push_back(i);
      }
    }
    others = std::move(left);
  }
  FlowSelection selection;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (chosen[i] != 0) {
      selection.source.push_back(i);
      selection.points.push_back(points.u[i], points.v[i], points.depth[i]);
    }
  }
  return selection;
}

/// Where the chosen points were in `frame` if they kept the pace that they had since `younger`.
FlowMatches prolonged(const FlowSelection& selection, const EarlierFrame& frame,
                      const EarlierFrame& younger, const FlowMatches& flow) {
  FlowMatches guess;
  if (!(frame.age > 0.0 && younger.age > 0.0)) {
    return guess;
  }
  const auto ratio = static_cast<float>(frame.age / younger.age);
  for (std::size_t k = 0; k < selection.source.size(); ++k) {
    const std::size_t i = selection.source[k];
    guess.u.push_back(selection.points.u[k] + ratio * (flow.u[i] - selection.points.u[k]));
    guess.v.push_back(selection.points.v[k] + ratio * (flow.v[i] - selection.points.v[k]));
  }
  return guess;
}

FlowMatches flowOf(const FlowSelection& selection, const EarlierFrame& frame,
                   const DynamicFeatureFilterInput& input, const OpticalFlowOptions& options,
                   const FlowMatches& guess) {
  const FlowMatches found = trackIntoEarlierFrame(*input.pyramid, *frame.pyramid,
                                                  selection.points.view(), options, guess);
  FlowMatches all;
  all.u.assign(input.points.size(), kNaN);
  all.v.assign(input.points.size(), kNaN);
  all.found = found.found;
  for (std::size_t k = 0; k < selection.source.size(); ++k) {
    all.u[selection.source[k]] = found.u[k];
    all.v[selection.source[k]] = found.v[k];
  }
  return all;
}

/// Steps 1 to 3 against one earlier frame; larger distances go into `distance`.
EarlierFrameReport compareWith(const EarlierFrame& frame, const FlowMatches& guess,
                               const FlowSelection& selection,
                               const DynamicFeatureFilterInput& input,
                               const DynamicFeatureFilterOptions& options,
                               DynamicFeatureFilterWorkspace& workspace,
                               std::vector<float>& distance) {
  EarlierFrameReport report;
  report.flow = flowOf(selection, frame, input, options.flow, guess);
  const PointPairsView pairs{report.flow.u, report.flow.v, input.points.u, input.points.v};
  if (options.distance != DistanceKind::kEgoMotion) {
    report.motion = estimateMotionModel(pairs, input.boxes, options.motion);
    report.used = report.motion.model.kind != TwoViewModelKind::kNone &&
                  report.motion.median_distance <= options.max_median_distance;
    if (report.used) {
      workspace.distance =
          modelDistances(report.motion.model, pairs, std::move(workspace.distance));
      keepLarger(workspace.distance, distance);
    }
  }
  if (options.distance != DistanceKind::kTwoView) {
    report.used = true;
    keepLarger(egoMotionDistancesTo(frame, pairs, input, options.ego_motion), distance);
  }
  return report;
}

/// Step 6, extended: the points vote on each other.
DynamicFeatureFilterResult withBelief(DynamicFeatureFilterResult result,
                                      const DynamicFeatureFilterInput& input,
                                      const DynamicFeatureFilterOptions& options,
                                      DynamicFeatureFilterWorkspace& workspace) {
  workspace.belief.surface = surfaceDepths(input.depth, input.points.u, input.points.v,
                                           options.surface, std::move(workspace.belief.surface));
  std::vector<std::uint8_t> in_box(input.points.size());
  for (std::size_t i = 0; i < in_box.size(); ++i) {
    in_box[i] = inAnyBox(input.boxes, input.points.u[i], input.points.v[i], 0.0f) ? 1 : 0;
  }
  MotionBeliefInput votes;
  votes.points = input.points;
  votes.distance = result.distance;
  votes.label = result.stage.label;
  votes.in_box = in_box;
  if (!result.earlier.empty()) {
    votes.earlier_u = result.earlier.front().flow.u;
    votes.earlier_v = result.earlier.front().flow.v;
  }
  const MotionBelief nothing;
  result.belief = updateMotionBelief(votes, input.memory != nullptr ? *input.memory : nothing,
                                     options.belief, workspace.belief);
  result.stage = applyMotionBelief(result.belief, in_box, workspace.belief.surface.is_dragged,
                                   std::move(result.stage), options.belief, options.belief_verdict);
  return result;
}

}  // namespace

DynamicFeatureFilterResult filterDynamicFeatures(const DynamicFeatureFilterInput& input,
                                                 const DynamicFeatureFilterOptions& options,
                                                 DynamicFeatureFilterWorkspace& workspace) {
  checkInput(input, options);
  checkKeyPoints(input.points);
  DynamicFeatureFilterResult result;
  result.distance.assign(input.points.size(), kNaN);
  if (distancesWanted(input, options)) {
    const FlowSelection selection = selectForFlow(input, options);
    for (std::size_t k = 0; k < input.earlier.size(); ++k) {
      const EarlierFrame& frame = input.earlier[k];
      const FlowMatches guess =
          k == 0 ? FlowMatches{}
                 : prolonged(selection, frame, input.earlier[k - 1], result.earlier[k - 1].flow);
      result.earlier.push_back(
          compareWith(frame, guess, selection, input, options, workspace, result.distance));
    }
  }
  result.stage =
      filterKeyPoints(input.points, result.distance, input.boxes, options.stage, workspace.stage);
  if (options.use_belief && options.stage.rule == FilterRule::kHmc && !input.depth.empty()) {
    result = withBelief(std::move(result), input, options, workspace);
  }
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

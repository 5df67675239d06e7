// SPDX-License-Identifier: BSD-3-Clause
#include "frame_filter/filter_steps.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include <opencv2/core.hpp>

#include "frame_filter/comparison.hpp"
#include "regions/frame_regions.hpp"

namespace hmcdyn::internal {
namespace {

/// Steps 4 to 7 on the chosen points. The others in a dynamic region are unmatched, until the
/// chosen ones vote on them.
FilterStageResult stageOfSelection(const FlowSelection& selection, const FrameRegions& regions,
                                   const DynamicFeatureFilterInput& input,
                                   const DynamicFeatureFilterOptions& options,
                                   const std::vector<float>& distance,
                                   DynamicFeatureFilterWorkspace& workspace) {
  workspace.distance.clear();
  for (const std::size_t i : selection.source) {
    workspace.distance.push_back(distance[i]);
  }
  workspace.membership = membershipOf(regions, selection.source, selection.points.view(),
                                      std::move(workspace.membership));
  const FilterStageResult& chosen =
      filterKeyPoints(selection.points.view(), workspace.distance, regions.boxes,
                      workspace.membership, options.stage, workspace.stage);

  const std::size_t n = input.points.size();
  FilterStageResult all;
  all.boxes = chosen.boxes;
  all.frame = chosen.frame;
  all.frame.points = n;
  all.frame.points_in_dynamic_boxes = 0;
  all.label.assign(n, PointLabel::kStatic);
  all.weight.assign(n, 1.0f);
  all.cluster.assign(n, kNoise);
  for (std::size_t b = 0; b < chosen.boxes.size(); ++b) {
    if (!chosen.boxes[b].verdict.is_dynamic) {
      continue;
    }
    for (const std::uint32_t i : regions.membership.pointsIn(b)) {
      all.frame.points_in_dynamic_boxes += all.label[i] == PointLabel::kStatic ? 1 : 0;
      all.label[i] = PointLabel::kUnmatched;
      all.weight[i] = std::min(
          all.weight[i],
          keptPointWeight(input.points.depth[i], chosen.boxes[b].anchor, options.stage.weights));
    }
  }
  for (std::size_t k = 0; k < selection.source.size(); ++k) {
    all.label[selection.source[k]] = chosen.label[k];
    all.weight[selection.source[k]] = chosen.weight[k];
    all.cluster[selection.source[k]] = chosen.cluster[k];
  }
  return all;
}

/// Where nobody knows what the camera did, no point outside all regions is believed to move, and
/// nothing is certain enough to speak for the camera in the next frame.
MotionBelief doubted(MotionBelief belief, Span<const std::uint8_t> in_region,
                     const MotionBeliefOptions& options) {
  const float uncertain = std::nextafter(options.certain_weight, 0.0f);
  for (std::size_t i = 0; i < belief.size(); ++i) {
    belief.weight[i] = std::min(belief.weight[i], uncertain);
    if (in_region[i] == 0 && belief.belief[i] > options.dynamic_belief) {
      belief.belief[i] = kNaN;
      belief.weight[i] = 0.0f;
    }
  }
  return belief;
}

}  // namespace

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

DynamicFeatureFilterResult judgeByDistance(const DynamicFeatureFilterInput& input,
                                           const FrameRegions& regions,
                                           Span<const std::uint8_t> in_region,
                                           const DynamicFeatureFilterOptions& options,
                                           DynamicFeatureFilterWorkspace& workspace) {
  DynamicFeatureFilterInput bounded = input;
  bounded.regions = regions.boxes;  // of a mask: where to look for motion, not what belongs to it
  FrameComparison comparison = compareFrames(bounded, in_region, options, workspace);
  DynamicFeatureFilterResult result;
  result.distance = std::move(comparison.distance);
  result.earlier = std::move(comparison.earlier);
  result.camera_unknown =
      options.require_known_camera && !result.earlier.empty() &&
      std::none_of(result.earlier.begin(), result.earlier.end(),
                   [](const EarlierFrameReport& report) { return report.camera_known; });
  result.stage = formsBeliefs(bounded, options)
                     ? stageOfSelection(comparison.followed, regions, bounded, options,
                                        result.distance, workspace)
                     : filterKeyPoints(bounded.points, result.distance, regions.boxes,
                                       regions.membership, options.stage, workspace.stage);
  return result;
}

DynamicFeatureFilterResult judgeByBelief(DynamicFeatureFilterResult result,
                                         const DynamicFeatureFilterInput& input,
                                         Span<const std::uint8_t> in_region,
                                         Span<const std::uint8_t> is_open,
                                         const DynamicFeatureFilterOptions& options,
                                         DynamicFeatureFilterWorkspace& workspace) {
  if (!formsBeliefs(input, options)) {
    return result;
  }
  MotionBeliefInput votes;
  votes.points = input.points;
  votes.distance = result.distance;
  votes.label = result.stage.label;
  votes.in_box = in_region;
  votes.is_open = is_open;
  if (!result.earlier.empty()) {
    votes.earlier_u = result.earlier.front().flow.u;
    votes.earlier_v = result.earlier.front().flow.v;
  }
  const MotionBelief nothing;
  result.belief = updateMotionBelief(votes, input.memory != nullptr ? *input.memory : nothing,
                                     options.belief, workspace.belief);
  if (result.camera_unknown) {
    result.belief = doubted(std::move(result.belief), in_region, options.belief);
  }
  result.stage = applyMotionBelief(result.belief, workspace.belief.surface.is_dragged,
                                   std::move(result.stage), options.belief, options.belief_verdict);
  return result;
}

}  // namespace hmcdyn::internal

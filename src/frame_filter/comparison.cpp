// SPDX-License-Identifier: BSD-3-Clause
#include "frame_filter/comparison.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <opencv2/core.hpp>

#include "frame_filter/frame_camera.hpp"

namespace hmcdyn::internal {
namespace {

cv::Size imageSize(const FlowPyramid& pyramid) {
  return pyramid.empty() ? cv::Size() : pyramid.front().size();
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

/// Whether distances are wanted: without a box, only what moved before can be dynamic.
bool distancesWanted(const DynamicFeatureFilterInput& input,
                     const DynamicFeatureFilterOptions& options) {
  return options.flow_background == 0 || !input.regions.boxes.empty() ||
         (input.memory != nullptr &&
          std::any_of(input.memory->belief.begin(), input.memory->belief.end(),
                      [&](float belief) { return belief > options.belief.dynamic_belief; }));
}

/// Where nobody votes, every point in a box needs a distance of its own.
FlowBudget budgetOf(const DynamicFeatureFilterOptions& options, bool forms_beliefs) {
  return {options.flow_margin, forms_beliefs ? options.flow_in_boxes : 0, options.flow_background};
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
  FlowSelection open;  // those that the caller has not matched
  FlowMatches open_guess;
  FlowMatches all;
  all.u.assign(input.points.size(), kNaN);
  all.v.assign(input.points.size(), kNaN);
  for (std::size_t k = 0; k < selection.source.size(); ++k) {
    const std::size_t i = selection.source[k];
    if (!frame.matched_u.empty() && std::isfinite(frame.matched_u[i]) &&
        std::isfinite(frame.matched_v[i])) {
      all.u[i] = frame.matched_u[i];
      all.v[i] = frame.matched_v[i];
      ++all.found;
      continue;
    }
    open.source.push_back(i);
    open.points.push_back(selection.points.u[k], selection.points.v[k], selection.points.depth[k]);
    if (!guess.u.empty()) {
      open_guess.u.push_back(guess.u[k]);
      open_guess.v.push_back(guess.v[k]);
    }
  }
  const FlowMatches found = trackIntoEarlierFrame(*input.pyramid, *frame.pyramid,
                                                  open.points.view(), options, open_guess);
  all.found += found.found;
  for (std::size_t k = 0; k < open.source.size(); ++k) {
    all.u[open.source[k]] = found.u[k];
    all.v[open.source[k]] = found.v[k];
  }
  return all;
}

/// What the memory knows of the key points, by `flow` to its frame. Outside the regions they are at
/// rest unless it knows better. Empty where there is no memory, or no need of it.
std::vector<KnownMotion> knownMotionOf(const FlowSelection& selection,
                                       Span<const std::uint8_t> in_region,
                                       const DynamicFeatureFilterInput& input,
                                       const FlowMatches& flow,
                                       const DynamicFeatureFilterOptions& options,
                                       DynamicFeatureFilterWorkspace& workspace) {
  const PointPairsView pairs{flow.u, flow.v, input.points.u, input.points.v};
  if (input.memory == nullptr || !formsBeliefs(input, options) ||
      backgroundSuffices(pairs, input.regions.boxes, options.two_view)) {
    return {};
  }
  FlowMatches chosen;
  std::vector<float> surface;
  for (const std::size_t i : selection.source) {
    chosen.u.push_back(flow.u[i]);
    chosen.v.push_back(flow.v[i]);
    surface.push_back(workspace.belief.surface.depth[i]);
  }
  const std::vector<KnownMotion> remembered =
      knownMotion(surface, chosen.u, chosen.v, *input.memory, options.belief, workspace.belief);
  std::vector<KnownMotion> known(input.points.size(), KnownMotion::kUnknown);
  for (std::size_t k = 0; k < remembered.size(); ++k) {
    const std::size_t i = selection.source[k];
    const bool background = remembered[k] == KnownMotion::kUnknown && in_region[i] == 0;
    known[i] = background ? KnownMotion::kAtRest : remembered[k];
  }
  return known;
}

/// Steps 2 and 3 against one earlier frame; larger distances go into `distance`.
EarlierFrameReport compareWith(const EarlierFrame& frame, FlowMatches flow,
                               const std::vector<KnownMotion>& known,
                               const DynamicFeatureFilterInput& input,
                               const DynamicFeatureFilterOptions& options,
                               DynamicFeatureFilterWorkspace& workspace,
                               std::vector<float>& distance) {
  EarlierFrameReport report;
  report.flow = std::move(flow);
  const PointPairsView pairs{report.flow.u, report.flow.v, input.points.u, input.points.v};
  if (options.distance != DistanceKind::kEgoMotion) {
    estimateCamera(frame, pairs, known, input, options, report);
    report.used = report.motion.model.kind != TwoViewModelKind::kNone &&
                  report.motion.median_distance <= options.max_median_distance;
    if (report.used) {
      workspace.distance =
          modelDistances(report.motion.model, pairs, std::move(workspace.distance));
      if (!report.camera_known && options.require_known_camera) {
        forgetOutside(input, workspace.distance);
      }
      keepLarger(workspace.distance, distance);
    }
  }
  if (options.distance != DistanceKind::kTwoView) {
    report.used = true;
    report.camera_known = true;
    keepLarger(egoMotionDistancesTo(frame, pairs, input, options.ego_motion), distance);
  }
  return report;
}

}  // namespace

bool formsBeliefs(const DynamicFeatureFilterInput& input,
                  const DynamicFeatureFilterOptions& options) {
  return options.use_belief && options.stage.rule == FilterRule::kHmc && !input.depth.empty();
}

FrameComparison compareFrames(const DynamicFeatureFilterInput& input,
                              Span<const std::uint8_t> in_region,
                              const DynamicFeatureFilterOptions& options,
                              DynamicFeatureFilterWorkspace& workspace) {
  FrameComparison result;
  result.distance.assign(input.points.size(), kNaN);
  if (formsBeliefs(input, options)) {
    workspace.belief.surface = surfaceDepths(input.depth, input.points.u, input.points.v,
                                             options.surface, std::move(workspace.belief.surface));
  }
  if (!distancesWanted(input, options)) {
    return result;
  }
  result.followed = selectForFlow(input.points, input.regions.boxes, imageSize(*input.pyramid),
                                  budgetOf(options, formsBeliefs(input, options)));
  std::vector<KnownMotion> known;
  for (std::size_t k = 0; k < input.earlier.size(); ++k) {
    const EarlierFrame& frame = input.earlier[k];
    const FlowMatches guess = k == 0 ? FlowMatches{}
                                     : prolonged(result.followed, frame, input.earlier[k - 1],
                                                 result.earlier[k - 1].flow);
    FlowMatches flow = flowOf(result.followed, frame, input, options.flow, guess);
    if (k == 0) {  // whose memory it is
      known = knownMotionOf(result.followed, in_region, input, flow, options, workspace);
    }
    result.earlier.push_back(
        compareWith(frame, std::move(flow), known, input, options, workspace, result.distance));
  }
  return result;
}

}  // namespace hmcdyn::internal

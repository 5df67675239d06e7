// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include <hmcdyn/dynamic_feature_filter.hpp>

#include "flow/flow_selection.hpp"
#include "frame_filter/frame_camera.hpp"
#include "regions/frame_regions.hpp"

namespace hmcdyn {
namespace {

cv::Size imageSize(const FlowPyramid& pyramid) {
  return pyramid.empty() ? cv::Size() : pyramid.front().size();
}

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
  const cv::Size image = imageSize(*input.pyramid);
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
  return options.flow_background == 0 || !input.boxes.empty() ||
         (input.memory != nullptr &&
          std::any_of(input.memory->belief.begin(), input.memory->belief.end(),
                      [&](float belief) { return belief > options.belief.dynamic_belief; }));
}

bool formsBeliefs(const DynamicFeatureFilterInput& input,
                  const DynamicFeatureFilterOptions& options) {
  return options.use_belief && options.stage.rule == FilterRule::kHmc && !input.depth.empty();
}

/// Where nobody votes, every point in a box needs a distance of its own.
internal::FlowBudget budgetOf(const DynamicFeatureFilterOptions& options, bool forms_beliefs) {
  return {options.flow_margin, forms_beliefs ? options.flow_in_boxes : 0, options.flow_background};
}

/// Where the chosen points were in `frame` if they kept the pace that they had since `younger`.
FlowMatches prolonged(const internal::FlowSelection& selection, const EarlierFrame& frame,
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

FlowMatches flowOf(const internal::FlowSelection& selection, const EarlierFrame& frame,
                   const DynamicFeatureFilterInput& input, const OpticalFlowOptions& options,
                   const FlowMatches& guess) {
  internal::FlowSelection open;  // those that the caller has not matched
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
std::vector<KnownMotion> knownMotionOf(const internal::FlowSelection& selection,
                                       Span<const std::uint8_t> in_region,
                                       const DynamicFeatureFilterInput& input,
                                       const FlowMatches& flow,
                                       const DynamicFeatureFilterOptions& options,
                                       DynamicFeatureFilterWorkspace& workspace) {
  const PointPairsView pairs{flow.u, flow.v, input.points.u, input.points.v};
  if (input.memory == nullptr || !formsBeliefs(input, options) ||
      backgroundSuffices(pairs, input.boxes, options.two_view)) {
    return {};
  }
  FlowMatches chosen;
  for (const std::size_t i : selection.source) {
    chosen.u.push_back(flow.u[i]);
    chosen.v.push_back(flow.v[i]);
  }
  const SurfaceDepths surface =
      surfaceDepths(input.depth, selection.points.u, selection.points.v, options.surface);
  const std::vector<KnownMotion> remembered = knownMotion(
      surface.depth, chosen.u, chosen.v, *input.memory, options.belief, workspace.belief);
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
    internal::estimateCamera(frame, pairs, known, input, options, report);
    report.used = report.motion.model.kind != TwoViewModelKind::kNone &&
                  report.motion.median_distance <= options.max_median_distance;
    if (report.used) {
      workspace.distance =
          modelDistances(report.motion.model, pairs, std::move(workspace.distance));
      if (!report.camera_known && options.require_known_camera) {
        internal::forgetOutside(input, workspace.distance);
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

/// Steps 4 to 7 on the chosen points. The others in a dynamic region are unmatched, until the
/// chosen ones vote on them.
FilterStageResult stageOfSelection(const internal::FlowSelection& selection,
                                   const internal::FrameRegions& regions,
                                   const DynamicFeatureFilterInput& input,
                                   const DynamicFeatureFilterOptions& options,
                                   const std::vector<float>& distance,
                                   DynamicFeatureFilterWorkspace& workspace) {
  workspace.distance.clear();
  for (const std::size_t i : selection.source) {
    workspace.distance.push_back(distance[i]);
  }
  workspace.membership = internal::membershipOf(regions, selection.source, selection.points.view(),
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

DynamicFeatureFilterResult filterDynamicFeatures(const DynamicFeatureFilterInput& input,
                                                 const DynamicFeatureFilterOptions& options,
                                                 DynamicFeatureFilterWorkspace& workspace) {
  checkInput(input, options);
  checkKeyPoints(input.points);
  const internal::FrameRegions regions = internal::regionsOf(input);
  DynamicFeatureFilterInput bounded = input;
  bounded.boxes = regions.boxes;  // of a mask: where to look for motion, not what belongs to it
  const bool forms_beliefs = formsBeliefs(bounded, options);
  const std::vector<std::uint8_t> in_region = internal::inRegion(regions, bounded.points.size());
  DynamicFeatureFilterResult result;
  result.distance.assign(bounded.points.size(), kNaN);
  internal::FlowSelection selection;
  if (distancesWanted(bounded, options)) {
    selection = internal::selectForFlow(bounded.points, bounded.boxes, imageSize(*bounded.pyramid),
                                        budgetOf(options, forms_beliefs));
    std::vector<KnownMotion> known;
    for (std::size_t k = 0; k < bounded.earlier.size(); ++k) {
      const EarlierFrame& frame = bounded.earlier[k];
      const FlowMatches guess =
          k == 0 ? FlowMatches{}
                 : prolonged(selection, frame, bounded.earlier[k - 1], result.earlier[k - 1].flow);
      FlowMatches flow = flowOf(selection, frame, bounded, options.flow, guess);
      if (k == 0) {  // whose memory it is
        known = knownMotionOf(selection, in_region, bounded, flow, options, workspace);
      }
      result.earlier.push_back(
          compareWith(frame, std::move(flow), known, bounded, options, workspace, result.distance));
    }
  }
  result.camera_unknown =
      options.require_known_camera && !result.earlier.empty() &&
      std::none_of(result.earlier.begin(), result.earlier.end(),
                   [](const EarlierFrameReport& report) { return report.camera_known; });
  if (!forms_beliefs) {
    result.stage = filterKeyPoints(bounded.points, result.distance, regions.boxes,
                                   regions.membership, options.stage, workspace.stage);
    return result;
  }
  result.stage = stageOfSelection(selection, regions, bounded, options, result.distance, workspace);
  return judgeByBelief(std::move(result), bounded, in_region, options, workspace);
}

DynamicFeatureFilterResult judgeByBelief(DynamicFeatureFilterResult result,
                                         const DynamicFeatureFilterInput& input,
                                         Span<const std::uint8_t> in_region,
                                         const DynamicFeatureFilterOptions& options,
                                         DynamicFeatureFilterWorkspace& workspace) {
  if (!formsBeliefs(input, options)) {
    return result;
  }
  workspace.belief.surface = surfaceDepths(input.depth, input.points.u, input.points.v,
                                           options.surface, std::move(workspace.belief.surface));
  MotionBeliefInput votes;
  votes.points = input.points;
  votes.distance = result.distance;
  votes.label = result.stage.label;
  votes.in_box = in_region;
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
  input.boxes = boxes;
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
  input.labels = labels;
  input.regions = regions;
  return filterTwoImages(earlier_gray, current_gray, input, options);
}

}  // namespace hmcdyn

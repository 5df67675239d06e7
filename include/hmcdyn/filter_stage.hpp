// SPDX-License-Identifier: BSD-3-Clause
// Steps 4 to 7 in one call: arrays in, labels and weights out.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <hmcdyn/detail/laned_sum.hpp>
#include <hmcdyn/detail/requirements.hpp>
#include <hmcdyn/peers/peer_rules.hpp>
#include <hmcdyn/steps/box_dynamism.hpp>
#include <hmcdyn/steps/cluster_filter.hpp>
#include <hmcdyn/steps/clustering.hpp>
#include <hmcdyn/steps/weights.hpp>
#include <hmcdyn/types.hpp>

namespace hmcdyn {

/// Who decides which points are dynamic.
enum class FilterRule : std::uint8_t {
  kNone,          ///< Nobody: every point is static.
  kBox,           ///< Every point in every box is dropped.
  kDynamicBox,    ///< Every point in every dynamic box is dropped; the paper's RS ablation.
  kEpipolar,      ///< One threshold in dynamic boxes; the paper's DF ablation.
  kTwoThreshold,  ///< SG-SLAM.
  kChiSquare,     ///< OVD-SLAM.
  kDepthRansac,   ///< YOLO-SLAM.
  kHmc,           ///< HMC-SLAM, the paper.
};

/// All rules.
inline constexpr FilterRule kFilterRules[] = {FilterRule::kNone,         FilterRule::kBox,
                                              FilterRule::kDynamicBox,   FilterRule::kEpipolar,
                                              FilterRule::kTwoThreshold, FilterRule::kChiSquare,
                                              FilterRule::kDepthRansac,  FilterRule::kHmc};

/// "none", "box", "dynamic_box", "epipolar", "two_threshold", "chi2", "depth_ransac" or "hmc".
inline const char* toString(FilterRule rule) noexcept {
  switch (rule) {
    case FilterRule::kNone:
      return "none";
    case FilterRule::kBox:
      return "box";
    case FilterRule::kDynamicBox:
      return "dynamic_box";
    case FilterRule::kEpipolar:
      return "epipolar";
    case FilterRule::kTwoThreshold:
      return "two_threshold";
    case FilterRule::kChiSquare:
      return "chi2";
    case FilterRule::kDepthRansac:
      return "depth_ransac";
    case FilterRule::kHmc:
      return "hmc";
  }
  return "invalid";
}

/// The rule of that name; nothing for an unknown name.
inline std::optional<FilterRule> filterRuleFromString(std::string_view name) noexcept {
  for (const FilterRule rule : kFilterRules) {
    if (name == toString(rule)) {
      return rule;
    }
  }
  return std::nullopt;
}

/// Who decides, and the options of each step.
struct FilterStageOptions {
  FilterRule rule = FilterRule::kHmc;   ///< Who decides which points are dynamic.
  BoxDynamismOptions boxes;             ///< Step 4, every rule.
  ClusteringOptions clustering;         ///< Step 5, kHmc.
  ClusterFilterOptions cluster_filter;  ///< Step 6, kHmc.
  WeightOptions weights;                ///< Step 7, kHmc.
  TwoThresholdOptions two_threshold;    ///< Of kTwoThreshold.
  ChiSquareOptions chi_square;          ///< Of kChiSquare.
  DepthRansacOptions depth_ransac;      ///< Of kDepthRansac.
};

/// What was decided about one box, and why.
struct BoxDecision {
  BoxVerdict verdict;                    ///< The box test's counts.
  std::vector<ClusterSummary> clusters;  ///< Clusters of a dynamic box, with each one's verdict.
  int first_cluster = 0;                 ///< Frame-wide number of clusters[0].
  int strongest = kNoise;  ///< Index in `clusters` of the anchor; kNoise = none qualified.
  DepthAnchor anchor;      ///< What the weights of this box refer to.
};

/// What was decided about the frame.
struct FrameDecision {
  float mean_distance = 0.0f;     ///< Over all key points with a distance (px); 0 without any.
  std::size_t points = 0;         ///< N.
  std::size_t measured = 0;       ///< Points with a distance.
  std::size_t boxes = 0;          ///< Detection boxes.
  std::size_t dynamic_boxes = 0;  ///< Those that move.
  std::size_t points_in_dynamic_boxes = 0;  ///< For the 0.6 rule of the pose refinement.
  std::size_t dynamic = 0;                  ///< Points labelled dynamic.
  std::size_t suspect = 0;                  ///< Points labelled suspect.
  std::size_t unmatched = 0;                ///< Points labelled unmatched.
};

/// What was decided about N key points.
struct FilterStageResult {
  std::vector<PointLabel> label;  ///< N verdicts.
  std::vector<float> weight;      ///< N weights, eq. 7, in [0, 1].
  /// N frame-wide cluster numbers; kNoise = in none. A point in several dynamic boxes has the
  /// number from the first that finds it dynamic, else from the first that has it in a cluster.
  std::vector<int> cluster;
  std::vector<BoxDecision> boxes;  ///< One a detection box.
  FrameDecision frame;             ///< The frame in numbers.
};

/// Memory that filterKeyPoints reuses from frame to frame, with its last result.
struct FilterStageWorkspace {
  FilterStageResult result;                  ///< Of the last call.
  BoxMembership membership;                  ///< Which points each box holds.
  BoxDynamism dynamism;                      ///< The box test.
  ClusteringWorkspace clustering;            ///< Of the last dynamic box.
  ClusterFilterResult cluster_filter;        ///< Of the last dynamic box.
  std::vector<BoxDecision> spare_boxes;      ///< Those of frames with more boxes, for their memory.
  std::vector<std::uint8_t> peer_flags;      ///< N flags of a peer's rule.
  DepthRansacWorkspace depth_ransac;         ///< Of FilterRule::kDepthRansac.
  std::vector<float> box_depth;              ///< Depths (m) of the points of the last dynamic box.
  std::vector<float> box_distance;           ///< Their distances (px).
  std::vector<float> box_threshold;          ///< Their thresholds (px).
  std::vector<float> box_weight;             ///< Their weights, 0 for dynamic ones.
  std::vector<std::uint8_t> in_dynamic_box;  ///< N flags.
};

namespace detail {

/// Standard deviation of the depths that are there; 0 without any.
inline float depthDeviation(Span<const float> depth) {
  const auto usable = [](float metres) {
    constexpr float kLargest = std::numeric_limits<float>::max();
    // Without a branch. NOLINTBEGIN(readability-implicit-bool-conversion)
    return (metres > 0.0f) & (metres <= kLargest);
    // NOLINTEND(readability-implicit-bool-conversion)
  };
  const LanedSum sum = sumOf(depth, usable, [](double metres) { return metres; });
  if (sum.number() == 0) {
    return 0.0f;
  }
  const double n = static_cast<double>(sum.number());
  const double mean = sum.total() / n;
  const auto square = [mean](double metres) { return (metres - mean) * (metres - mean); };
  return static_cast<float>(std::sqrt(sumOf(depth, usable, square).total() / n));
}

inline float meanDistance(Span<const float> distance, std::size_t& measured) {
  const LanedSum sum = sumOf(
      distance, [](float pixels) { return pixels == pixels; },
      [](double pixels) { return pixels; });
  measured = sum.number();
  return measured == 0 ? 0.0f : static_cast<float>(sum.total() / static_cast<double>(measured));
}

/// Brings `boxes` to size n with every decision reset, whose memory is kept.
inline void resetDecisions(std::size_t n, std::vector<BoxDecision>& boxes,
                           std::vector<BoxDecision>& spare) {
  for (; boxes.size() > n; boxes.pop_back()) {
    spare.push_back(std::move(boxes.back()));
  }
  for (; boxes.size() < n && !spare.empty(); spare.pop_back()) {
    boxes.push_back(std::move(spare.back()));
  }
  boxes.resize(n);
  for (BoxDecision& box : boxes) {
    std::vector<ClusterSummary> clusters = std::move(box.clusters);
    clusters.clear();
    box = BoxDecision{};
    box.clusters = std::move(clusters);
  }
}

/// Brings the verdicts on one box's points into the frame's. A point in several dynamic boxes keeps
/// the strictest: dynamic before unmatched before suspect, and the smallest weight.
inline void takeOver(Span<const std::uint32_t> members, const Clustering& clustering,
                     int first_cluster, FilterStageWorkspace& workspace) {
  // Plain pointers: the arrays do not overlap, but the compiler cannot know.
  const std::uint8_t* const is_dynamic = workspace.cluster_filter.is_dynamic.data();
  const float* const distance = workspace.box_distance.data();
  const float* const box_weight = workspace.box_weight.data();
  const int* const box_cluster = clustering.label.data();
  std::uint8_t* const in_dynamic_box = workspace.in_dynamic_box.data();
  PointLabel* const label = workspace.result.label.data();
  float* const weight = workspace.result.weight.data();
  int* const cluster = workspace.result.cluster.data();
  for (std::size_t k = 0; k < members.size(); ++k) {
    const std::uint32_t i = members[k];
    const bool was_dynamic = label[i] == PointLabel::kDynamic;
    const bool dynamic = is_dynamic[k] != 0;
    const PointLabel kept = std::isnan(distance[k]) ? PointLabel::kUnmatched : PointLabel::kSuspect;
    in_dynamic_box[i] = 1;
    weight[i] = std::min(weight[i], box_weight[k]);
    label[i] = dynamic || was_dynamic ? PointLabel::kDynamic : kept;
    if (box_cluster[k] != kNoise && (cluster[i] == kNoise || (dynamic && !was_dynamic))) {
      cluster[i] = first_cluster + box_cluster[k];
    }
  }
}

/// Steps 5 to 7 on dynamic box `b`.
inline void filterDynamicBox(std::size_t b, const KeyPointsView& points, Span<const float> distance,
                             const FilterStageOptions& options, FilterStageWorkspace& workspace) {
  FilterStageResult& result = workspace.result;
  const Span<const std::uint32_t> members = workspace.membership.pointsIn(b);
  workspace.box_depth.resize(members.size());
  workspace.box_distance.resize(members.size());
  workspace.box_threshold.resize(members.size());
  for (std::size_t k = 0; k < members.size(); ++k) {
    workspace.box_depth[k] = points.depth[members[k]];
    workspace.box_distance[k] = distance[members[k]];
    workspace.box_threshold[k] = workspace.dynamism.threshold[members[k]];
  }

  const Clustering& clustering = clusterBox(workspace.box_depth, workspace.box_distance,
                                            options.clustering, workspace.clustering);  // step 5
  ClusterFilterResult& filtered = workspace.cluster_filter;
  filtered = filterClusters(workspace.box_depth, workspace.box_distance, workspace.box_threshold,
                            clustering, result.frame.mean_distance, options.cluster_filter,
                            std::move(filtered));  // step 6

  BoxDecision& decision = result.boxes[b];
  decision.clusters.assign(filtered.clusters.begin(), filtered.clusters.end());
  decision.strongest = filtered.strongest;
  decision.anchor.sigma = depthDeviation(workspace.box_depth);
  if (filtered.strongest != kNoise) {
    decision.anchor.depth =
        filtered.clusters[static_cast<std::size_t>(filtered.strongest)].mean_depth;
  }

  workspace.box_weight = keptPointWeights(workspace.box_depth, decision.anchor, options.weights,
                                          std::move(workspace.box_weight));  // step 7
  for (std::size_t k = 0; k < members.size(); ++k) {
    workspace.box_weight[k] *= static_cast<float>(1 - filtered.is_dynamic[k]);  // 0 when dynamic
  }
  takeOver(members, clustering, decision.first_cluster, workspace);
}

/// The peers' rules know two verdicts only.
inline const std::vector<std::uint8_t>& peerFlags(const KeyPointsView& points,
                                                  Span<const float> distance,
                                                  Span<const DetectionBox> boxes,
                                                  const FilterStageOptions& options,
                                                  FilterStageWorkspace& workspace) {
  std::vector<std::uint8_t>& flags = workspace.peer_flags;
  switch (options.rule) {
    case FilterRule::kBox:
      flags = dropWholeBoxes(points.size(), workspace.membership, std::move(flags));
      return flags;
    case FilterRule::kDynamicBox:
      flags = workspace.in_dynamic_box;
      return flags;
    case FilterRule::kEpipolar:
      flags =
          dropBeyondThreshold(distance, workspace.membership, workspace.dynamism, std::move(flags));
      return flags;
    case FilterRule::kTwoThreshold:
      flags =
          dropByTwoThresholds(distance, boxes, workspace.membership, options.boxes.person_class_id,
                              options.two_threshold, std::move(flags));
      return flags;
    case FilterRule::kChiSquare:
      flags = dropByChiSquare(distance, workspace.membership, options.chi_square, std::move(flags));
      return flags;
    case FilterRule::kDepthRansac:
      return dropByDepthRansac(points.depth, workspace.membership, options.depth_ransac,
                               workspace.depth_ransac);
    case FilterRule::kNone:
    case FilterRule::kHmc:
      break;
  }
  flags.assign(points.size(), 0);
  return flags;
}

inline void countLabels(const FilterStageWorkspace& workspace, FrameDecision& frame) {
  // Counters of the loop's own, in 32 bits, so that it vectorises.
  std::uint32_t in_dynamic_boxes = 0;
  std::uint32_t dynamic = 0;
  std::uint32_t suspect = 0;
  std::uint32_t unmatched = 0;
  const PointLabel* const label = workspace.result.label.data();
  const std::uint8_t* const in_dynamic_box = workspace.in_dynamic_box.data();
  for (std::size_t i = 0; i < workspace.result.label.size(); ++i) {
    in_dynamic_boxes += in_dynamic_box[i];
    dynamic += label[i] == PointLabel::kDynamic ? 1U : 0U;
    suspect += label[i] == PointLabel::kSuspect ? 1U : 0U;
    unmatched += label[i] == PointLabel::kUnmatched ? 1U : 0U;
  }
  frame.points_in_dynamic_boxes = in_dynamic_boxes;
  frame.dynamic = dynamic;
  frame.suspect = suspect;
  frame.unmatched = unmatched;
}

inline void checkFilterInput(const KeyPointsView& points, Span<const float> distance,
                             const FilterStageOptions& options) {
  checkKeyPoints(points);
  if (distance.size() != points.size()) {
    throw std::invalid_argument("filterKeyPoints: " + std::to_string(points.size()) +
                                " key points, but " + std::to_string(distance.size()) +
                                " distances; expected equal sizes");
  }
  checkOptions(options.clustering);
  checkOptions(options.cluster_filter);
  checkOptions(options.weights);
  checkOptions(options.two_threshold);
  checkOptions(options.chi_square);
  checkOptions(options.depth_ransac);
}

/// Steps 4 to 7 with the workspace's membership.
inline const FilterStageResult& filterMembers(const KeyPointsView& points,
                                              Span<const float> distance,
                                              Span<const DetectionBox> boxes,
                                              const FilterStageOptions& options,
                                              FilterStageWorkspace& workspace) {
  FilterStageResult& result = workspace.result;
  result.label.assign(points.size(), PointLabel::kStatic);
  result.weight.assign(points.size(), 1.0f);
  result.cluster.assign(points.size(), kNoise);
  resetDecisions(boxes.size(), result.boxes, workspace.spare_boxes);
  result.frame = FrameDecision{};
  FrameDecision& frame = result.frame;
  frame.points = points.size();
  frame.boxes = boxes.size();
  frame.mean_distance = meanDistance(distance, frame.measured);

  workspace.in_dynamic_box.assign(points.size(), 0);
  workspace.dynamism = testBoxes(distance, boxes, workspace.membership, options.boxes,
                                 std::move(workspace.dynamism));  // step 4

  int clusters = 0;
  for (std::size_t b = 0; b < boxes.size(); ++b) {
    BoxDecision& decision = result.boxes[b];
    decision.verdict = workspace.dynamism.boxes[b];
    decision.first_cluster = clusters;
    if (!decision.verdict.is_dynamic) {
      continue;
    }
    ++frame.dynamic_boxes;
    if (options.rule == FilterRule::kHmc) {
      filterDynamicBox(b, points, distance, options, workspace);
      clusters += static_cast<int>(decision.clusters.size());
    } else {
      for (const std::uint32_t i : workspace.membership.pointsIn(b)) {
        workspace.in_dynamic_box[i] = 1;
      }
    }
  }
  if (options.rule != FilterRule::kHmc && options.rule != FilterRule::kNone) {
    const std::vector<std::uint8_t>& dynamic =
        peerFlags(points, distance, boxes, options, workspace);
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (dynamic[i] != 0) {
        result.label[i] = PointLabel::kDynamic;
        result.weight[i] = 0.0f;
      }
    }
  }
  countLabels(workspace, frame);
  return result;
}

}  // namespace detail

/// Labels and weighs the key points of a frame whose distances are known: box test, clustering,
/// cluster filter, weights, or the rule of a peer.
///
/// Outside dynamic boxes every point is static with weight 1. A frame without boxes, or without any
/// distance, is a frame of static points; `frame` in the result says so.
///
/// @param distance N distances (px), NaN = none (modelDistances, egoMotionDistances, or your own).
/// @param workspace keeps the memory and the result; valid until the next call with it.
/// @throws std::invalid_argument when sizes differ or an option is out of range.
inline const FilterStageResult& filterKeyPoints(const KeyPointsView& points,
                                                Span<const float> distance,
                                                Span<const DetectionBox> boxes,
                                                const FilterStageOptions& options,
                                                FilterStageWorkspace& workspace) {
  detail::checkFilterInput(points, distance, options);
  workspace.membership = assignToBoxes(points, boxes, std::move(workspace.membership));
  return detail::filterMembers(points, distance, boxes, options, workspace);
}

/// The same where something else than boxes says which points belong together: a mask
/// (regions.hpp), for one.
/// @param boxes one a region: its class decides the threshold of the test, its borders nothing.
/// @param membership the points of each region (assignToRegions, or your own).
/// @throws std::invalid_argument also when membership and boxes differ in number, or the membership
/// is not one of these points.
inline const FilterStageResult& filterKeyPoints(const KeyPointsView& points,
                                                Span<const float> distance,
                                                Span<const DetectionBox> boxes,
                                                const BoxMembership& membership,
                                                const FilterStageOptions& options,
                                                FilterStageWorkspace& workspace) {
  detail::checkFilterInput(points, distance, options);
  workspace.membership = membership;
  return detail::filterMembers(points, distance, boxes, options, workspace);
}

/// The same without a workspace.
inline FilterStageResult filterKeyPoints(const KeyPointsView& points, Span<const float> distance,
                                         Span<const DetectionBox> boxes,
                                         const FilterStageOptions& options = {}) {
  FilterStageWorkspace workspace;
  filterKeyPoints(points, distance, boxes, options, workspace);
  return std::move(workspace.result);
}

}  // namespace hmcdyn

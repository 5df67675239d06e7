// SPDX-License-Identifier: BSD-3-Clause
#include "frame_filter/decision.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include <hmcdyn/steps/weights.hpp>

namespace hmcdyn::internal {
namespace {

PointReason reasonOf(const DynamicFeatureFilterResult& details, std::size_t i, MaskLabel seen,
                     bool in_region, const FrameFilterOptions& options) {
  if (seen == MaskLabel::kMoving) {
    return PointReason::kMask;
  }
  if (seen == MaskLabel::kStatic && in_region) {
    return PointReason::kRoom;
  }
  switch (details.stage.label[i]) {
    case PointLabel::kStatic:
      return in_region ? PointReason::kAtRest : PointReason::kOutside;
    case PointLabel::kDynamic:
      return details.distance[i] > options.expert.stage.boxes.person_distance_threshold
                 ? PointReason::kMoves
                 : PointReason::kMovesAlong;
    case PointLabel::kSuspect:
    case PointLabel::kUnmatched:
      break;
  }
  return PointReason::kApart;
}

/// How much speaks against a dropped point: how much it is believed to move, the less the more of a
/// guess that is; without beliefs, how far it is from where it should be.
float caseAgainst(const DynamicFeatureFilterResult& details, std::size_t i) {
  if (details.belief.size() != details.stage.label.size()) {
    const float distance = details.distance[i];
    return std::isnan(distance) ? std::numeric_limits<float>::max() : distance;
  }
  constexpr float kGuess = 0.1f;  // so that among mere guesses, too, the less moving comes first
  const float moving = details.belief.belief[i];
  return std::isnan(moving) ? 0.5f * kGuess : moving * (kGuess + details.belief.weight[i]);
}

}  // namespace

FrameFilterResult decide(DynamicFeatureFilterResult details, std::vector<MaskLabel> seen,
                         Span<const std::uint8_t> in_region, const FrameFilterOptions& options) {
  FrameFilterResult result;
  const FrameDecision& decision = details.stage.frame;
  result.soft_weights =
      useSoftWeights(decision.points_in_dynamic_boxes, decision.points, options.soft_weight_gate);
  result.lambda = details.stage.weight;
  result.weight =
      result.soft_weights ? result.lambda : hardWeights(Span<const float>(result.lambda));
  result.label = details.stage.label;
  for (std::size_t i = 0; i < result.lambda.size(); ++i) {
    result.keep.push_back(result.lambda[i] > 0.0f ? 1 : 0);
    result.reason.push_back(reasonOf(details, i, seen.empty() ? MaskLabel::kUnknown : seen[i],
                                     in_region[i] != 0, options));
  }
  result.mask = std::move(seen);
  result.details = std::move(details);
  return result;
}

FrameFilterStatus statusOf(const DynamicFeatureFilterResult& details, FilterRule rule,
                           bool is_first) {
  if (is_first && rule != FilterRule::kNone) {
    return FrameFilterStatus::kNoHistory;
  }
  if (details.earlier.empty()) {
    return FrameFilterStatus::kNothingToDo;
  }
  return details.camera_unknown ? FrameFilterStatus::kCameraUnknown : FrameFilterStatus::kFiltered;
}

void dropRegions(Span<const std::uint8_t> in_region, FrameFilterResult& result) {
  for (std::size_t i = 0; i < in_region.size(); ++i) {
    if (in_region[i] != 0) {
      result.keep[i] = 0;
      result.weight[i] = 0.0f;
      result.lambda[i] = 0.0f;
      result.label[i] = PointLabel::kUnmatched;
      result.reason[i] = PointReason::kNoHistory;
    }
  }
}

FrameFilterResult keepEnough(FrameFilterResult result, const FrameFilterOptions& options) {
  std::vector<std::size_t> dropped;
  for (std::size_t i = 0; i < result.keep.size(); ++i) {
    if (result.keep[i] == 0) {
      dropped.push_back(i);
    }
  }
  result.kept = result.keep.size() - dropped.size();
  const auto wanted = static_cast<std::size_t>(options.min_kept);
  if (result.kept >= wanted) {
    return result;
  }
  std::stable_sort(dropped.begin(), dropped.end(), [&](std::size_t a, std::size_t b) {
    return caseAgainst(result.details, a) < caseAgainst(result.details, b);
  });
  dropped.resize(std::min(dropped.size(), wanted - result.kept));
  for (const std::size_t i : dropped) {
    result.keep[i] = 1;
    result.weight[i] = kRescueWeight;
    result.reason[i] = PointReason::kForNumber;
  }
  result.kept_for_number = dropped.size();
  result.kept += dropped.size();
  return result;
}

}  // namespace hmcdyn::internal

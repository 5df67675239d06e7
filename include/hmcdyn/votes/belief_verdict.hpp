// SPDX-License-Identifier: BSD-3-Clause
// Step 6, extended: labels and weights of what is believed to move.
#pragma once

#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>

#include <hmcdyn/detail/requirements.hpp>
#include <hmcdyn/filter_stage.hpp>
#include <hmcdyn/types.hpp>
#include <hmcdyn/votes/motion_belief.hpp>

namespace hmcdyn {

/// What applyMotionBelief makes of points whose flow may not be their own.
struct BeliefVerdictOptions {
  /// Weight, in place of eq. 7's, of a kept point that a nearer surface may drag along: a corner at
  /// a silhouette moves with it, whatever it lies on. 0..1.
  float dragged_weight = 0.0f;
};

/// Turns beliefs into labels and weights, for the points in boxes and for those believed to move.
/// Believed to move: dynamic, weight 0. Else a point that the steps before called dynamic or
/// unmatched becomes suspect; a suspect's weight is multiplied with 1 - belief. Unjudged points
/// keep what the steps before said, unless a nearer surface may have dragged them: then they are
/// suspect at best. A box's decision stays as it was.
///
/// @param is_dragged N flags (SurfaceDepths). @param stage of the same N points.
/// @throws std::invalid_argument when sizes differ or a weight is out of range.
inline FilterStageResult applyMotionBelief(const MotionBelief& belief,
                                           Span<const std::uint8_t> is_dragged,
                                           FilterStageResult stage,
                                           const MotionBeliefOptions& options = {},
                                           const BeliefVerdictOptions& verdict = {}) {
  checkOptions(options);
  checkBelief(belief, "applyMotionBelief: belief");
  const std::size_t n = stage.label.size();
  if (stage.weight.size() != n || belief.size() != n || is_dragged.size() != n) {
    throw std::invalid_argument("applyMotionBelief: " + std::to_string(n) + " labels, but " +
                                std::to_string(stage.weight.size()) + " weights, " +
                                std::to_string(belief.size()) + " beliefs and " +
                                std::to_string(is_dragged.size()) + " flags; expected equal sizes");
  }
  if (!(verdict.dragged_weight >= 0.0f && verdict.dragged_weight <= 1.0f)) {
    throw std::invalid_argument("BeliefVerdictOptions::dragged_weight is " +
                                std::to_string(verdict.dragged_weight) +
                                "; expected a weight in [0, 1]");
  }
  for (std::size_t i = 0; i < n; ++i) {
    const float moving = belief.belief[i];
    PointLabel& label = stage.label[i];
    if (std::isnan(moving)) {
      if (is_dragged[i] != 0 && label != PointLabel::kStatic) {
        label = PointLabel::kSuspect;
        stage.weight[i] = verdict.dragged_weight;
      }
      continue;
    }
    if (moving > options.dynamic_belief) {
      label = PointLabel::kDynamic;
      stage.weight[i] = 0.0f;
    } else if (label != PointLabel::kStatic) {
      const float kept = label == PointLabel::kSuspect ? stage.weight[i] : 1.0f;
      label = PointLabel::kSuspect;
      stage.weight[i] = is_dragged[i] != 0 ? verdict.dragged_weight : kept * (1.0f - moving);
    }
  }
  stage.frame.dynamic = 0;
  stage.frame.suspect = 0;
  stage.frame.unmatched = 0;
  for (const PointLabel label : stage.label) {
    stage.frame.dynamic += label == PointLabel::kDynamic ? 1 : 0;
    stage.frame.suspect += label == PointLabel::kSuspect ? 1 : 0;
    stage.frame.unmatched += label == PointLabel::kUnmatched ? 1 : 0;
  }
  return stage;
}

}  // namespace hmcdyn

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include <hmcdyn/votes/motion_belief.hpp>

namespace hmcdyn::test {

/// Every option set. At 2 m the depth reach is 0.03 + 0.02 * 4 = 0.11 m.
inline MotionBeliefOptions fixedBeliefOptions() {
  MotionBeliefOptions options;
  options.sigma = 80.0f;
  options.memory_sigma = 24.0f;
  options.depth_sigma_floor = 0.03f;
  options.depth_sigma_quadratic = 0.02f;
  options.still_distance = 0.3f;
  options.moving_distance = 1.0f;
  options.dynamic_evidence = 0.5f;
  options.quiet_weight = 0.3f;
  options.inferred_weight = 0.3f;
  options.dragged_weight = 0.05f;
  options.unmeasured_depth = 9.0f;
  options.min_weight = 0.2f;
  options.memory_gain = 2.0f;
  options.memory_decay = 0.9f;
  options.weight_cap = 20.0f;
  options.dynamic_belief = 0.6f;
  options.certain_weight = 0.5f;
  return options;
}

/// A frame's points, each with all that it is judged by.
struct BeliefFrame {
  KeyPoints points;
  std::vector<float> distance;
  std::vector<PointLabel> label;
  std::vector<std::uint8_t> in_box;
  std::vector<float> earlier_u;
  std::vector<float> earlier_v;
  SurfaceDepths surface;

  /// A measured point in a box that was where it is.
  BeliefFrame& add(float u, float v, float depth, float at_distance) {
    points.push_back(u, v, depth);
    distance.push_back(at_distance);
    label.push_back(PointLabel::kSuspect);
    in_box.push_back(1);
    earlier_u.push_back(u);
    earlier_v.push_back(v);
    surface.depth.push_back(depth);
    surface.support.push_back(SurfaceSupport::kMeasured);
    surface.is_dragged.push_back(0);
    return *this;
  }
  BeliefFrame& add(int count, float u, float v, float depth, float at_distance) {
    for (int k = 0; k < count; ++k) {
      add(u, v, depth, at_distance);
    }
    return *this;
  }
  BeliefFrame& support(SurfaceSupport of_last) {
    surface.support.back() = of_last;
    if (of_last == SurfaceSupport::kBeside || of_last == SurfaceSupport::kNone) {
      surface.depth.back() = 0.0f;
    }
    return *this;
  }
  BeliefFrame& dragged() {
    surface.is_dragged.back() = 1;
    return *this;
  }
  BeliefFrame& outsideBoxes() {
    in_box.assign(points.size(), 0);
    return *this;
  }

  MotionBeliefInput input() const {
    return {points.view(), distance, label, in_box, earlier_u, earlier_v};
  }
};

inline MotionBelief update(const BeliefFrame& frame, const MotionBelief& memory = {},
                           const MotionBeliefOptions& options = fixedBeliefOptions()) {
  MotionBeliefWorkspace workspace;
  workspace.surface = frame.surface;
  return updateMotionBelief(frame.input(), memory, options, workspace);
}

}  // namespace hmcdyn::test

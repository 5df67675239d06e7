// SPDX-License-Identifier: BSD-3-Clause
// Step 7: how much a kept point of a dynamic box counts.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Core>

#include <hmcdyn/detail/planar_points.hpp>
#include <hmcdyn/detail/requirements.hpp>
#include <hmcdyn/types.hpp>

namespace hmcdyn {

/// Weights where eq. 8 has nothing to compare.
struct WeightOptions {
  /// Weight of a kept point without depth, where eq. 8 has nothing to compare; 0..1.
  float without_depth = 0.5f;
  /// Weight of a kept point in a dynamic box in which no cluster qualified as the strongest; 0..1.
  float without_anchor = 0.5f;
};

/// @throws std::invalid_argument naming the first option out of range.
inline void checkOptions(const WeightOptions& options) {
  const auto require = [](float value, const char* name) {
    if (!(value >= 0.0f && value <= 1.0f)) {
      throw std::invalid_argument(std::string("WeightOptions::") + name + " is " +
                                  std::to_string(value) + "; expected a weight in [0, 1]");
    }
  };
  require(options.without_depth, "without_depth");
  require(options.without_anchor, "without_anchor");
}

/// Depths of one dynamic box, as eq. 8 needs them.
struct DepthAnchor {
  /// d_maxaver: mean depth of the strongest dynamic cluster (m); not finite = none.
  float depth = kNaN;
  float sigma = 0.0f;  ///< Standard deviation of all depths in the box (m).
};

/// G of eq. 8: exp(-(z - z_max)^2 / (2 sigma^2)); its limit for sigma = 0 (1 at the anchor's depth,
/// 0 elsewhere). The depths must be finite.
inline float depthSimilarity(float depth, const DepthAnchor& anchor) noexcept {
  const double difference = static_cast<double>(depth) - static_cast<double>(anchor.depth);
  if (!(anchor.sigma > 0.0f)) {
    return difference == 0.0 ? 1.0f : 0.0f;
  }
  const auto ratio = static_cast<float>(difference / static_cast<double>(anchor.sigma));
  return std::exp(-0.5f * ratio * ratio);  // eq. 8
}

/// lambda of eq. 7 for a point that was kept in a dynamic box, in [0, 1], never NaN.
/// @param depth of the point (m); 0, negative or NaN = none.
inline float keptPointWeight(float depth, const DepthAnchor& anchor,
                             const WeightOptions& options = {}) noexcept {
  if (!std::isfinite(anchor.depth)) {
    return options.without_anchor;
  }
  if (!hasDepth(depth)) {
    return options.without_depth;
  }
  return 1.0f - depthSimilarity(depth, anchor);  // eq. 7
}

namespace detail {

/// keptPointWeight of kLanes points and an anchor with a depth and a deviation.
inline void weighLanes(const float* depth, const DepthAnchor& anchor, const WeightOptions& options,
                       float* weight) {
  using Lanes = Eigen::Array<float, static_cast<int>(kLanes), 1>;
  const Lanes z = Eigen::Map<const Lanes>(depth);
  const Lanes ratio = (z - anchor.depth) / anchor.sigma;
  const Lanes kept = 1.0f - (-0.5f * ratio * ratio).exp();  // eq. 7 and 8
  const auto has_depth = z > 0.0f && z <= std::numeric_limits<float>::max();
  Eigen::Map<Lanes>{weight} = has_depth.select(kept, options.without_depth);
}

}  // namespace detail

/// keptPointWeight of N points, several at a time; equal to it but for the rounding of exp (1e-6),
/// and the same for a point wherever it stands.
/// @param depth N depths (m). @param reuse a vector whose memory is taken over.
inline std::vector<float> keptPointWeights(Span<const float> depth, const DepthAnchor& anchor,
                                           const WeightOptions& options = {},
                                           std::vector<float> reuse = {}) {
  reuse.resize(depth.size());
  // Both as frames have them, so that no difference or quotient overflows.
  if (!(hasDepth(anchor.depth) && hasDepth(anchor.sigma))) {
    std::transform(depth.begin(), depth.end(), reuse.begin(),
                   [&](float z) { return keptPointWeight(z, anchor, options); });
    return reuse;
  }
  const std::size_t in_lanes = depth.size() / detail::kLanes * detail::kLanes;
  for (std::size_t i = 0; i < in_lanes; i += detail::kLanes) {
    detail::weighLanes(depth.data() + i, anchor, options, reuse.data() + i);
  }
  // The last lanes are filled up: fewer would take another exp.
  std::array<float, detail::kLanes> rest{};
  std::copy(depth.begin() + in_lanes, depth.end(), rest.begin());
  detail::weighLanes(rest.data(), anchor, options, rest.data());
  std::copy_n(rest.data(), depth.size() - in_lanes, reuse.data() + in_lanes);
  return reuse;
}

/// Whether a frame is worth the weights of eq. 7: more than `gate` of its key points lie in
/// dynamic boxes (section III-D; the paper's gate is 0.6). Below, use hardWeights(). No points:
/// false.
/// @throws std::invalid_argument for more points in boxes than points, or a gate outside 0..1.
inline bool useSoftWeights(std::size_t points_in_dynamic_boxes, std::size_t points,
                           double gate = 0.6) {
  if (points_in_dynamic_boxes > points) {
    throw std::invalid_argument(
        "points_in_dynamic_boxes is " + std::to_string(points_in_dynamic_boxes) +
        ", expected at most the number of points, " + std::to_string(points));
  }
  if (!(gate >= 0.0 && gate <= 1.0)) {
    throw std::invalid_argument("gate is " + std::to_string(gate) + ", expected 0..1");
  }
  // The quotient, not gate * points: correctly rounded, 3 of 5 is not more than 0.6.
  return points > 0 &&
         static_cast<double>(points_in_dynamic_boxes) / static_cast<double>(points) > gate;
}

/// Weights for a frame below the gate: 0 stays 0, everything else becomes 1.
/// @throws std::invalid_argument for a negative weight or a NaN.
inline std::vector<float> hardWeights(Span<const float> weights) {
  std::vector<float> hard;
  hard.reserve(weights.size());
  for (std::size_t i = 0; i < weights.size(); ++i) {
    if (!(weights[i] >= 0.0f)) {
      throw std::invalid_argument("weights[" + std::to_string(i) + "] is " +
                                  std::to_string(weights[i]) + ", expected 0..1");
    }
    hard.push_back(weights[i] > 0.0f ? 1.0f : 0.0f);
  }
  return hard;
}

}  // namespace hmcdyn

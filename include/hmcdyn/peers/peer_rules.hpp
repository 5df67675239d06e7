// SPDX-License-Identifier: BSD-3-Clause
// What other dynamic SLAM systems do with the same inputs, so that one call compares them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <hmcdyn/detail/requirements.hpp>
#include <hmcdyn/steps/box_dynamism.hpp>
#include <hmcdyn/types.hpp>

namespace hmcdyn {

namespace detail {

inline void requireOption(bool good, const char* name, float value, const char* expected) {
  if (!good) {
    throw std::invalid_argument(std::string(name) + " is " + std::to_string(value) + "; expected " +
                                expected);
  }
}

}  // namespace detail

/// Two thresholds, a tighter one inside people's boxes (SG-SLAM: Cheng, Sun, Zhang, Zhang,
/// "SG-SLAM: a real-time RGB-D visual SLAM toward dynamic scenes with semantic and geometric
/// information", IEEE TIM 2023; values as in its published configuration).
struct TwoThresholdOptions {
  float outside_threshold =
      1.0f;                       ///< Distance beyond which a point outside people is dropped (px).
  float inside_threshold = 0.2f;  ///< The same in a person's box (px).
  /// If fewer than this share of the key points would remain, all are kept.
  float revert_share = 0.1f;
};

/// Chi-square test (OVD-SLAM: He, Li, Wang, Wang, "OVD-SLAM: an online visual SLAM for dynamic
/// environments", IEEE Sensors Journal 2023), here on the squared epipolar distance in the boxes.
struct ChiSquareOptions {
  float sigma = 1.0f;        ///< Standard deviation of a distance (px).
  float quantile = 3.8415f;  ///< 95 % of chi-square with one degree of freedom.
};

/// Depth-RANSAC (YOLO-SLAM: Wu, Guo, Gao, You, Liu, Chen, "YOLO-SLAM: a semantic SLAM system
/// towards dynamic environment with geometric constraint", Neural Computing and Applications 2022).
struct DepthRansacOptions {
  float variance_threshold = 0.43f;  ///< Of a candidate with the two drawn depths (m^2).
  float confidence = 0.99f;          ///< Of having drawn two points of the dynamic thing.
  int max_iterations = 200;          ///< Draws a box.
  std::uint32_t seed = 1;            ///< Of the draws.
};

/// @throws std::invalid_argument naming the first option out of range.
inline void checkOptions(const TwoThresholdOptions& options) {
  detail::requireOption(options.outside_threshold >= 0.0f, "TwoThresholdOptions::outside_threshold",
                        options.outside_threshold, "a value >= 0 (px)");
  detail::requireOption(options.inside_threshold >= 0.0f, "TwoThresholdOptions::inside_threshold",
                        options.inside_threshold, "a value >= 0 (px)");
  detail::requireOption(options.revert_share >= 0.0f && options.revert_share <= 1.0f,
                        "TwoThresholdOptions::revert_share", options.revert_share,
                        "a share in [0, 1]");
}

/// @throws std::invalid_argument naming the first option out of range.
inline void checkOptions(const ChiSquareOptions& options) {
  detail::requireOption(options.sigma > 0.0f, "ChiSquareOptions::sigma", options.sigma,
                        "a value > 0 (px)");
  detail::requireOption(options.quantile >= 0.0f, "ChiSquareOptions::quantile", options.quantile,
                        "a value >= 0");
}

/// @throws std::invalid_argument naming the first option out of range.
inline void checkOptions(const DepthRansacOptions& options) {
  detail::requireOption(options.variance_threshold > 0.0f, "DepthRansacOptions::variance_threshold",
                        options.variance_threshold, "a value > 0 (m^2)");
  detail::requireOption(options.confidence > 0.0f && options.confidence < 1.0f,
                        "DepthRansacOptions::confidence", options.confidence,
                        "a probability in (0, 1)");
  detail::requireOption(options.max_iterations >= 1, "DepthRansacOptions::max_iterations",
                        static_cast<float>(options.max_iterations), "a count >= 1");
}

// The rules take over the memory of `reuse` for their result.

/// Flags (1 = dynamic): every point of every box (the paper's RS ablation).
/// @throws std::invalid_argument when a box holds a point beyond `points`.
inline std::vector<std::uint8_t> dropWholeBoxes(std::size_t points, const BoxMembership& membership,
                                                std::vector<std::uint8_t> reuse = {}) {
  detail::checkMembership("dropWholeBoxes", membership, points);
  std::vector<std::uint8_t> dynamic = std::move(reuse);
  dynamic.assign(points, 0);
  for (const std::uint32_t i : membership.indices) {
    dynamic[i] = 1;
  }
  return dynamic;
}

/// Flags: points of dynamic boxes beyond their own threshold (the paper's DF ablation).
/// @throws std::invalid_argument when sizes differ.
inline std::vector<std::uint8_t> dropBeyondThreshold(Span<const float> distance,
                                                     const BoxMembership& membership,
                                                     const BoxDynamism& dynamism,
                                                     std::vector<std::uint8_t> reuse = {}) {
  if (dynamism.boxes.size() != membership.boxes() || dynamism.threshold.size() != distance.size()) {
    throw std::invalid_argument("dropBeyondThreshold: " + std::to_string(distance.size()) +
                                " distances in " + std::to_string(membership.boxes()) +
                                " boxes, but dynamism of " +
                                std::to_string(dynamism.threshold.size()) + " points in " +
                                std::to_string(dynamism.boxes.size()) + " boxes");
  }
  detail::checkMembership("dropBeyondThreshold", membership, distance.size());
  std::vector<std::uint8_t> dynamic = std::move(reuse);
  dynamic.assign(distance.size(), 0);
  for (std::size_t b = 0; b < membership.boxes(); ++b) {
    if (!dynamism.boxes[b].is_dynamic) {
      continue;
    }
    for (const std::uint32_t i : membership.pointsIn(b)) {
      if (distance[i] > dynamism.threshold[i]) {
        dynamic[i] = 1;
      }
    }
  }
  return dynamic;
}

/// Flags: TwoThresholdOptions' rule.
/// @throws std::invalid_argument when sizes differ or an option is out of range.
inline std::vector<std::uint8_t> dropByTwoThresholds(Span<const float> distance,
                                                     Span<const DetectionBox> boxes,
                                                     const BoxMembership& membership,
                                                     int person_class_id,
                                                     const TwoThresholdOptions& options = {},
                                                     std::vector<std::uint8_t> reuse = {}) {
  checkOptions(options);
  if (membership.boxes() != boxes.size()) {
    throw std::invalid_argument("dropByTwoThresholds: membership of " +
                                std::to_string(membership.boxes()) + " boxes for " +
                                std::to_string(boxes.size()) + " boxes");
  }
  detail::checkMembership("dropByTwoThresholds", membership, distance.size());
  std::vector<std::uint8_t> dynamic = std::move(reuse);
  dynamic.assign(distance.size(), 0);
  std::vector<std::uint8_t>& in_person = dynamic;  // until its verdict replaces it
  for (std::size_t b = 0; b < boxes.size(); ++b) {
    if (boxes[b].class_id == person_class_id) {
      for (const std::uint32_t i : membership.pointsIn(b)) {
        in_person[i] = 1;
      }
    }
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < distance.size(); ++i) {
    const float threshold =
        in_person[i] != 0 ? options.inside_threshold : options.outside_threshold;
    dynamic[i] = distance[i] > threshold ? 1 : 0;
    kept += dynamic[i] == 0 ? 1 : 0;
  }
  if (static_cast<float>(kept) < options.revert_share * static_cast<float>(distance.size())) {
    std::fill(dynamic.begin(), dynamic.end(), std::uint8_t{0});
  }
  return dynamic;
}

/// Flags: points in boxes that fail ChiSquareOptions' test, d^2 / sigma^2 > quantile.
/// @throws std::invalid_argument when sizes differ or an option is out of range.
inline std::vector<std::uint8_t> dropByChiSquare(Span<const float> distance,
                                                 const BoxMembership& membership,
                                                 const ChiSquareOptions& options = {},
                                                 std::vector<std::uint8_t> reuse = {}) {
  checkOptions(options);
  detail::checkMembership("dropByChiSquare", membership, distance.size());
  std::vector<std::uint8_t> dynamic = std::move(reuse);
  dynamic.assign(distance.size(), 0);
  for (const std::uint32_t i : membership.indices) {
    const float normalized = distance[i] / options.sigma;
    dynamic[i] = normalized * normalized > options.quantile ? 1 : 0;
  }
  return dynamic;
}

/// Memory that dropByDepthRansac reuses, with its last result.
struct DepthRansacWorkspace {
  std::vector<std::uint8_t> dynamic;   ///< N flags, the last result.
  std::vector<float> depth;            ///< Of a box's points that have one.
  std::vector<std::uint32_t> indices;  ///< Of the same points.
};

namespace detail {

/// Two drawn depths of a box.
struct DepthPair {
  float a = 0.0f;
  float b = 0.0f;

  /// Whether the variance of both and a third stays below the threshold; YOLO-SLAM eq. 5.
  bool agreesWith(float depth, float variance_threshold) const {
    const float mean = (a + b + depth) / 3.0f;
    const float variance =
        ((a - mean) * (a - mean) + (b - mean) * (b - mean) + (depth - mean) * (depth - mean)) /
        3.0f;
    return variance < variance_threshold;
  }
};

/// The pair with which most depths agree; none where no depth agrees with any pair.
inline std::optional<DepthPair> depthConsensus(const std::vector<float>& depth,
                                               const DepthRansacOptions& options,
                                               std::mt19937& random) {
  std::optional<DepthPair> best;
  std::size_t most = 0;
  const std::size_t n = depth.size();
  double wanted = options.max_iterations;
  for (int iteration = 0; iteration < options.max_iterations && iteration < wanted; ++iteration) {
    // Not std::uniform_int_distribution, whose draws differ between standard libraries.
    const float a = depth[random() % n];
    const float b = depth[random() % n];
    const DepthPair pair{a, b};
    std::size_t inliers = 0;
    for (const float z : depth) {
      inliers += pair.agreesWith(z, options.variance_threshold) ? 1 : 0;
    }
    if (inliers > most) {
      most = inliers;
      best = pair;
      const double share = static_cast<double>(most) / static_cast<double>(n);
      const double miss = 1.0 - share * share;
      wanted = miss <= 0.0 ? 0.0
                           : std::log(1.0 - static_cast<double>(options.confidence)) /
                                 std::log(miss);  // YOLO-SLAM eq. 8
    }
  }
  return best;
}

}  // namespace detail

/// Flags: in every box, the largest set of points of like depth (DepthRansacOptions). Points
/// without depth are kept.
/// @param workspace keeps the memory and the result; valid until the next call with it.
/// @throws std::invalid_argument when sizes differ or an option is out of range.
inline const std::vector<std::uint8_t>& dropByDepthRansac(Span<const float> depth,
                                                          const BoxMembership& membership,
                                                          const DepthRansacOptions& options,
                                                          DepthRansacWorkspace& workspace) {
  checkOptions(options);
  detail::checkMembership("dropByDepthRansac", membership, depth.size());
  std::mt19937 random(options.seed);
  workspace.dynamic.assign(depth.size(), 0);
  for (std::size_t b = 0; b < membership.boxes(); ++b) {
    workspace.depth.clear();
    workspace.indices.clear();
    for (const std::uint32_t i : membership.pointsIn(b)) {
      if (hasDepth(depth[i])) {
        workspace.depth.push_back(depth[i]);
        workspace.indices.push_back(i);
      }
    }
    if (workspace.depth.size() < 3) {
      continue;
    }
    const auto best = detail::depthConsensus(workspace.depth, options, random);
    for (const std::uint32_t i : workspace.indices) {
      if (best && best->agreesWith(depth[i], options.variance_threshold)) {
        workspace.dynamic[i] = 1;
      }
    }
  }
  return workspace.dynamic;
}

/// The same without a workspace.
inline std::vector<std::uint8_t> dropByDepthRansac(Span<const float> depth,
                                                   const BoxMembership& membership,
                                                   const DepthRansacOptions& options = {}) {
  DepthRansacWorkspace workspace;
  dropByDepthRansac(depth, membership, options, workspace);
  return std::move(workspace.dynamic);
}

}  // namespace hmcdyn

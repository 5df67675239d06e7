// SPDX-License-Identifier: BSD-3-Clause
// Step 6: which clusters of a dynamic box move, anchored at the strongest one.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <hmcdyn/detail/requirements.hpp>
#include <hmcdyn/steps/clustering.hpp>
#include <hmcdyn/types.hpp>

namespace hmcdyn {

/// When a cluster of a dynamic box counts as moving (section III-C).
struct ClusterFilterOptions {
  /// The strongest dynamic cluster has at least this many points.
  int min_cluster_size = 5;
  /// ... and at least this mean distance (px). 0 is the paper's rule, which also anchors in a box
  /// whose clusters all stand still, and then throws its background away.
  float min_strongest_distance = 0.8f;
  /// Rough screening: a cluster is dynamic when its mean distance exceeds the frame's by this
  /// factor (1 = the paper) ...
  float screening_ratio = 1.0f;
  /// ... and this floor (px). 0 is the paper's rule; the mean over a frame can be a few hundredths
  /// of a pixel, below the noise of any match.
  float screening_floor = 0.5f;
  /// A point whose match was lost is dynamic when its depth lies between the depths of a dynamic
  /// cluster: fast things are just what optical flow loses. Not in the paper.
  bool place_unmatched_by_depth = true;
};

/// @throws std::invalid_argument naming the first option out of range.
inline void checkOptions(const ClusterFilterOptions& options) {
  const auto require = [](bool good, const char* name, float value, const char* expected) {
    if (!good) {
      throw std::invalid_argument(std::string("ClusterFilterOptions::") + name + " is " +
                                  std::to_string(value) + "; expected " + expected);
    }
  };
  require(options.min_cluster_size >= 1, "min_cluster_size",
          static_cast<float>(options.min_cluster_size), "a count >= 1");
  require(options.min_strongest_distance >= 0.0f, "min_strongest_distance",
          options.min_strongest_distance, "a value >= 0 (px)");
  require(options.screening_ratio >= 0.0f, "screening_ratio", options.screening_ratio,
          "a value >= 0");
  require(options.screening_floor >= 0.0f, "screening_floor", options.screening_floor,
          "a value >= 0 (px)");
}

/// Why a cluster was judged as it was.
enum class ClusterVerdict : std::uint8_t {
  kStatic,          ///< No rule applied.
  kStrongest,       ///< (a) The strongest dynamic cluster.
  kScreened,        ///< (b) Rough screening: mean distance above the frame's.
  kDepthNeighbour,  ///< (c) As deep as the strongest cluster.
};

/// "static", "strongest", "screened" or "depth neighbour".
inline const char* toString(ClusterVerdict verdict) noexcept {
  switch (verdict) {
    case ClusterVerdict::kStatic:
      return "static";
    case ClusterVerdict::kStrongest:
      return "strongest";
    case ClusterVerdict::kScreened:
      return "screened";
    case ClusterVerdict::kDepthNeighbour:
      return "depth neighbour";
  }
  return "invalid";
}

/// One cluster in numbers, and what was decided about it.
struct ClusterSummary {
  std::size_t points = 0;                            ///< Points in the cluster.
  float mean_distance = 0.0f;                        ///< Of its points (px).
  float mean_depth = 0.0f;                           ///< Of its points (m).
  float min_depth = 0.0f;                            ///< The nearest point's (m).
  float max_depth = 0.0f;                            ///< The farthest point's (m).
  ClusterVerdict verdict = ClusterVerdict::kStatic;  ///< Why it is dynamic, if it is.
};

/// What was decided about the N points of one box.
struct ClusterFilterResult {
  std::vector<ClusterSummary> clusters;  ///< By cluster label.
  std::vector<std::uint8_t> is_dynamic;  ///< N flags.
  int strongest = kNoise;  ///< Label of the strongest dynamic cluster; kNoise = none qualified.
};

namespace detail {

/// Labels index the clusters' summaries: one that is out of range would read and write beside them.
inline void checkClusterLabels(const Clustering& clustering) {
  int smallest = 0;
  int largest = kNoise;
  for (const int label : clustering.label) {
    smallest = std::min(smallest, label);
    largest = std::max(largest, label);
  }
  if (clustering.clusters < 0 || smallest < kNoise || largest >= clustering.clusters) {
    throw std::invalid_argument(
        "filterClusters: cluster labels reach from " + std::to_string(smallest) + " to " +
        std::to_string(largest) + " in a clustering of " + std::to_string(clustering.clusters) +
        " clusters; expected -1 (noise), or a number below that of the clusters");
  }
}

inline std::vector<ClusterSummary> summarizeClusters(Span<const float> depth,
                                                     Span<const float> distance,
                                                     const Clustering& clustering,
                                                     std::vector<ClusterSummary> reuse) {
  reuse.assign(static_cast<std::size_t>(clustering.clusters), ClusterSummary{});
  for (ClusterSummary& cluster : reuse) {
    cluster.min_depth = std::numeric_limits<float>::infinity();
  }
  for (std::size_t i = 0; i < depth.size(); ++i) {
    if (clustering.label[i] == kNoise) {
      continue;
    }
    ClusterSummary& cluster = reuse[static_cast<std::size_t>(clustering.label[i])];
    ++cluster.points;
    cluster.mean_distance += distance[i];
    cluster.mean_depth += depth[i];
    cluster.min_depth = std::min(cluster.min_depth, depth[i]);
    cluster.max_depth = std::max(cluster.max_depth, depth[i]);
  }
  for (ClusterSummary& cluster : reuse) {
    cluster.mean_distance /= static_cast<float>(cluster.points);
    cluster.mean_depth /= static_cast<float>(cluster.points);
  }
  return reuse;
}

/// (a): among the clusters that are large enough, the largest mean distance; the nearer cluster
/// (the smaller label) at a tie.
inline int findStrongest(const std::vector<ClusterSummary>& clusters,
                         const ClusterFilterOptions& options) {
  int strongest = kNoise;
  float largest = -1.0f;
  for (std::size_t c = 0; c < clusters.size(); ++c) {
    if (clusters[c].points >= static_cast<std::size_t>(options.min_cluster_size) &&
        clusters[c].mean_distance >= options.min_strongest_distance &&
        clusters[c].mean_distance > largest) {
      largest = clusters[c].mean_distance;
      strongest = static_cast<int>(c);
    }
  }
  return strongest;
}

inline bool withinDynamicDepth(const std::vector<ClusterSummary>& clusters, float depth) {
  return std::any_of(clusters.begin(), clusters.end(), [depth](const ClusterSummary& cluster) {
    return cluster.verdict != ClusterVerdict::kStatic && depth >= cluster.min_depth &&
           depth <= cluster.max_depth;
  });
}

}  // namespace detail

/// The paper's dynamic point-cluster filter (section III-C) on the points of one dynamic box:
///  (a) the strongest dynamic cluster: the largest mean distance among clusters of enough points;
///  (b) rough screening: clusters whose mean distance exceeds that of all key points of the frame;
///  (c) depth neighbours: clusters whose mean depth differs from the strongest cluster's by less
///      than that cluster's own depth extent (max - min);
///  (d) last sweep: in static clusters and among noise, points beyond their own threshold.
/// Where no cluster qualifies in (a), only (d) applies.
///
/// @param depth N depths (m), none = 0 or NaN. @param distance N distances (px), NaN = none.
/// @param threshold N distance thresholds (px), from testBoxes.
/// @param clustering of these N points.
/// @param frame_mean_distance over all key points of the frame that have a distance (px).
/// @throws std::invalid_argument when sizes differ, an option is out of range, or a cluster label
/// is neither kNoise nor below clustering.clusters.
inline ClusterFilterResult filterClusters(Span<const float> depth, Span<const float> distance,
                                          Span<const float> threshold, const Clustering& clustering,
                                          float frame_mean_distance,
                                          const ClusterFilterOptions& options = {},
                                          ClusterFilterResult reuse = {}) {
  checkOptions(options);
  const std::size_t n = depth.size();
  if (distance.size() != n || threshold.size() != n || clustering.label.size() != n) {
    throw std::invalid_argument(
        "filterClusters: " + std::to_string(n) + " depths, " + std::to_string(distance.size()) +
        " distances, " + std::to_string(threshold.size()) + " thresholds, " +
        std::to_string(clustering.label.size()) + " cluster labels; expected equal sizes");
  }
  detail::checkClusterLabels(clustering);
  std::vector<ClusterSummary>& clusters = reuse.clusters;
  clusters = detail::summarizeClusters(depth, distance, clustering, std::move(clusters));

  reuse.strongest = detail::findStrongest(clusters, options);  // (a)
  if (reuse.strongest != kNoise) {
    ClusterSummary& anchor = clusters[static_cast<std::size_t>(reuse.strongest)];
    const float depth_extent = anchor.max_depth - anchor.min_depth;
    const float screening =
        std::max(options.screening_ratio * frame_mean_distance, options.screening_floor);
    for (ClusterSummary& cluster : clusters) {
      if (cluster.mean_distance > screening) {  // (b)
        cluster.verdict = ClusterVerdict::kScreened;
      } else if (std::abs(cluster.mean_depth - anchor.mean_depth) < depth_extent) {  // (c)
        cluster.verdict = ClusterVerdict::kDepthNeighbour;
      }
    }
    anchor.verdict = ClusterVerdict::kStrongest;
  }

  reuse.is_dynamic.assign(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    const int label = clustering.label[i];
    const bool in_dynamic_cluster =
        label != kNoise &&
        clusters[static_cast<std::size_t>(label)].verdict != ClusterVerdict::kStatic;
    const bool swept = distance[i] > threshold[i];  // (d); false without a distance
    bool placed = false;
    if (std::isnan(distance[i])) {
      placed = options.place_unmatched_by_depth && hasDepth(depth[i]) &&
               detail::withinDynamicDepth(clusters, depth[i]);
    }
    // No shortcuts: which of them applies is as good as random.
    reuse.is_dynamic[i] = static_cast<std::uint8_t>(in_dynamic_cluster) |
                          static_cast<std::uint8_t>(swept) | static_cast<std::uint8_t>(placed);
  }
  return reuse;
}

}  // namespace hmcdyn

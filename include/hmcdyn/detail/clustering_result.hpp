// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace hmcdyn {

/// The label of a point that belongs to no cluster.
inline constexpr int kNoise = -1;

/// Clusters of N points.
struct Clustering {
  std::vector<int> label;             ///< N labels: 0 .. clusters - 1, or kNoise.
  std::vector<std::uint8_t> is_core;  ///< N flags: 1 for a core point.
  int clusters = 0;                   ///< Number of clusters.
};

namespace detail {

/// A cluster before it has its number, with its lexicographically smallest core point.
struct UnnumberedCluster {
  float x = 0.0f;
  float y = 0.0f;
  std::uint32_t index = 0;  ///< How the backend knows it.

  bool operator<(const UnnumberedCluster& other) const noexcept {
    return x < other.x || (x == other.x && y < other.y);
  }
};

/// Makes numbers[index] the number of a cluster. Core points that are equal share a cluster, so no
/// two clusters tie.
inline void numberClusters(std::vector<UnnumberedCluster>& clusters, std::vector<int>& numbers) {
  std::sort(clusters.begin(), clusters.end());
  for (std::size_t k = 0; k < clusters.size(); ++k) {
    numbers[clusters[k].index] = static_cast<int>(k);
  }
}

/// The nearest core point of a border point so far; at equal distance, the lexicographically
/// smaller.
struct NearestCore {
  float power;
  float x = 0.0f;
  float y = 0.0f;
  std::uint32_t index = 0;
  bool found = false;

  explicit NearestCore(float largest_power) : power(largest_power) {}

  void offer(float candidate_power, float candidate_x, float candidate_y, std::uint32_t candidate) {
    const bool smaller = candidate_x < x || (candidate_x == x && candidate_y < y);
    if (candidate_power < power || (candidate_power == power && (!found || smaller))) {
      *this = NearestCore(candidate_power);
      x = candidate_x;
      y = candidate_y;
      index = candidate;
      found = true;
    }
  }
};

}  // namespace detail

}  // namespace hmcdyn

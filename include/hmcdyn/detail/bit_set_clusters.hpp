// SPDX-License-Identifier: BSD-3-Clause
// Density clusters of few points in the plane: all pairs are compared, neighbourhoods are bit sets.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <hmcdyn/detail/bits.hpp>
#include <hmcdyn/detail/clustering_result.hpp>
#include <hmcdyn/detail/planar_points.hpp>

namespace hmcdyn::detail {

/// Memory of clusterByBitSets.
struct BitSetWorkspace {
  std::vector<std::uint32_t> columns;  ///< Neighbours 32 w .. 32 w + 31 of each point, w by w.
  std::vector<std::uint64_t> rows;     ///< Neighbours of each point, point by point.
  std::vector<std::uint64_t> reach;    ///< Cluster by cluster: core points and their neighbours.
  std::vector<UnnumberedCluster> clusters;
  std::vector<int> number;
};

/// Sets bit j of point i's bits where i and j are neighbours, for j from `first` to first + 3.
inline void markFourNeighbours(const PlanarPoints& points, std::size_t first, const Disc& disc,
                               std::uint32_t* bits_of_point) {
  const float* const x = points.x.data();
  const float* const y = points.y.data();
  const float xa = x[first], xb = x[first + 1], xc = x[first + 2], xd = x[first + 3];
  const float ya = y[first], yb = y[first + 1], yc = y[first + 2], yd = y[first + 3];
  const std::uint32_t bit = std::uint32_t{1} << (first % 32);
  for (std::size_t block = 0; block < points.size; block += kLanes) {
    for (std::size_t i = block; i < block + kLanes; ++i) {
      const std::uint32_t a = disc.contains(x[i] - xa, y[i] - ya) ? bit : 0;
      const std::uint32_t b = disc.contains(x[i] - xb, y[i] - yb) ? bit << 1 : 0;
      const std::uint32_t c = disc.contains(x[i] - xc, y[i] - yc) ? bit << 2 : 0;
      const std::uint32_t d = disc.contains(x[i] - xd, y[i] - yd) ? bit << 3 : 0;
      bits_of_point[i] |= (a | b) | (c | d);
    }
  }
}

/// A set of up to 64 Words points.
template <std::size_t Words>
using BitSet = std::array<std::uint64_t, Words>;

template <std::size_t Words, class Visit>
void forEachOne(const BitSet<Words>& set, Visit&& visit) {
  for (std::size_t w = 0; w < Words; ++w) {
    for (std::uint64_t rest = set[w]; rest != 0; rest &= rest - 1) {
      visit(static_cast<std::uint32_t>(64 * w + lowestOne(rest)));
    }
  }
}

/// The steps of clusterByBitSets on N <= 64 Words points.
template <std::size_t Words>
class BitSetClusters {
 public:
  using Set = BitSet<Words>;

  BitSetClusters(const PlanarPoints& points, const Disc& disc, BitSetWorkspace& workspace)
      : points_(points), disc_(disc), workspace_(workspace) {}

  void run(int min_points, Clustering& result) {
    compareAllPairs();
    const Set core = findCorePoints(min_points, result);
    Set left = core;
    Set taken{};
    Set contested{};  // border points within reach of more than one cluster
    workspace_.clusters.clear();
    workspace_.reach.clear();
    for (std::size_t w = 0; w < Words; ++w) {
      while (left[w] != 0) {
        const Set reach =
            growCluster(static_cast<std::uint32_t>(64 * w + lowestOne(left[w])), core);
        workspace_.clusters.push_back(
            {0.0f, 0.0f, static_cast<std::uint32_t>(workspace_.clusters.size())});
        workspace_.reach.insert(workspace_.reach.end(), reach.begin(), reach.end());
        for (std::size_t v = 0; v < Words; ++v) {
          contested[v] |= taken[v] & reach[v];
          taken[v] |= reach[v];
          left[v] &= ~reach[v];
        }
      }
    }
    result.clusters = static_cast<int>(workspace_.clusters.size());
    writeLabels(core, result);
    forEachOne<Words>(contested, [&](std::uint32_t i) { settle(i, core, result); });
  }

 private:
  Set row(std::uint32_t i) const {
    Set set;
    for (std::size_t w = 0; w < Words; ++w) {
      set[w] = workspace_.rows[Words * i + w];
    }
    return set;
  }

  void compareAllPairs() {
    const std::size_t stride = points_.padded();
    workspace_.columns.assign(2 * Words * stride, 0);
    for (std::size_t j = 0; j < points_.size; j += 4) {
      markFourNeighbours(points_, j, disc_, workspace_.columns.data() + j / 32 * stride);
    }
  }

  /// Turns columns into rows and counts.
  Set findCorePoints(int min_points, Clustering& result) {
    const std::size_t stride = points_.padded();
    const std::uint32_t* const columns = workspace_.columns.data();
    workspace_.rows.resize(Words * stride);
    std::uint64_t* const rows = workspace_.rows.data();
    Set core{};
    for (std::size_t i = 0; i < points_.size; ++i) {
      std::uint32_t neighbours = 0;
      for (std::size_t w = 0; w < Words; ++w) {
        const std::uint64_t word =
            columns[2 * w * stride + i] |
            (static_cast<std::uint64_t>(columns[(2 * w + 1) * stride + i]) << 32);
        rows[Words * i + w] = word;
        neighbours += countOnes(word);
      }
      const bool is_core = neighbours >= static_cast<std::uint32_t>(min_points);
      result.is_core[i] = is_core ? 1 : 0;
      core[i / 64] |= static_cast<std::uint64_t>(is_core ? 1 : 0) << (i % 64);
    }
    return core;
  }

  /// The core points that are connected with `seed`, and their neighbours.
  Set growCluster(std::uint32_t seed, const Set& core) const {
    Set reach{};
    Set grown{};
    Set frontier{};
    frontier[seed / 64] = std::uint64_t{1} << (seed % 64);
    for (std::uint64_t any = 1; any != 0;) {
      forEachOne<Words>(frontier, [&](std::uint32_t i) {
        for (std::size_t w = 0; w < Words; ++w) {
          reach[w] |= workspace_.rows[Words * i + w];
        }
      });
      any = 0;
      for (std::size_t w = 0; w < Words; ++w) {
        grown[w] |= frontier[w];
        frontier[w] = reach[w] & core[w] & ~grown[w];
        any |= frontier[w];
      }
    }
    return reach;
  }

  Set reachOf(std::size_t cluster) const {
    Set reach;
    for (std::size_t w = 0; w < Words; ++w) {
      reach[w] = workspace_.reach[Words * cluster + w];
    }
    return reach;
  }

  void writeLabels(const Set& core, Clustering& result) {
    std::vector<UnnumberedCluster>& clusters = workspace_.clusters;
    workspace_.number.assign(clusters.size(), 0);
    if (clusters.size() > 1) {
      for (UnnumberedCluster& cluster : clusters) {
        Set cores = reachOf(cluster.index);
        for (std::size_t w = 0; w < Words; ++w) {
          cores[w] &= core[w];
        }
        cluster.x = std::numeric_limits<float>::infinity();
        forEachOne<Words>(cores, [&](std::uint32_t i) {
          if (points_.x[i] < cluster.x || (points_.x[i] == cluster.x && points_.y[i] < cluster.y)) {
            cluster.x = points_.x[i];
            cluster.y = points_.y[i];
          }
        });
      }
      numberClusters(clusters, workspace_.number);
    }
    std::fill(result.label.begin(), result.label.end(), kNoise);
    for (std::size_t k = 0; k < clusters.size(); ++k) {
      const int number = workspace_.number[k];
      int* const label = result.label.data();
      forEachOne<Words>(reachOf(k), [&](std::uint32_t i) { label[i] = number; });
    }
  }

  /// A border point goes to its nearest core point's cluster.
  void settle(std::uint32_t i, const Set& core, Clustering& result) const {
    Set cores = row(i);
    for (std::size_t w = 0; w < Words; ++w) {
      cores[w] &= core[w];
    }
    NearestCore nearest(disc_.squared_radius);
    forEachOne<Words>(cores, [&](std::uint32_t j) {
      nearest.offer(disc_.power(points_.x[j] - points_.x[i], points_.y[j] - points_.y[i]),
                    points_.x[j], points_.y[j], j);
    });
    result.label[i] = result.label[nearest.index];
  }

  const PlanarPoints& points_;
  const Disc& disc_;
  BitSetWorkspace& workspace_;
};

/// The most points that clusterByBitSets takes.
inline constexpr std::size_t kBitSetCapacity = 256;

/// Clusters up to kBitSetCapacity points; labels and flags of `result` have their size already.
inline void clusterByBitSets(const PlanarPoints& points, float radius, int min_points,
                             BitSetWorkspace& workspace, Clustering& result) {
  const Disc disc(radius);
  if (points.size <= 64) {
    BitSetClusters<1>(points, disc, workspace).run(min_points, result);
  } else if (points.size <= 128) {
    BitSetClusters<2>(points, disc, workspace).run(min_points, result);
  } else {
    BitSetClusters<4>(points, disc, workspace).run(min_points, result);
  }
}

}  // namespace hmcdyn::detail

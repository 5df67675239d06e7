// SPDX-License-Identifier: BSD-3-Clause
// Density clusters of few points in the plane: all pairs are compared, neighbourhoods are bit sets.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
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
  std::vector<int> number;  ///< Of each cluster.
  std::vector<int> label;   ///< In whole blocks.
};

/// Smallest value among the points of a block whose bit is set; infinity without any.
inline float smallestOfBlock(std::uint32_t bits, const float* value) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  std::array<float, kBlock> low;  // NOLINT(cppcoreguidelines-pro-type-member-init): written next
  for (std::size_t i = 0; i < kBlock; ++i) {
    low[i] = (bits & kBits.bit[i]) != 0 ? value[i] : kInfinity;
  }
  HMCDYN_KEEP_LOOP
  for (std::size_t i = 0; i < kBlock / 2; ++i) {
    low[i] = low[i + kBlock / 2] < low[i] ? low[i + kBlock / 2] : low[i];
  }
  HMCDYN_KEEP_LOOP
  for (std::size_t i = 0; i < kLanes; ++i) {
    low[i] = low[i + kLanes] < low[i] ? low[i + kLanes] : low[i];
  }
  const float a = std::min(std::min(low[0], low[1]), std::min(low[2], low[3]));
  const float b = std::min(std::min(low[4], low[5]), std::min(low[6], low[7]));
  return std::min(a, b);
}

/// Bits of a block's points whose value is the wanted one.
inline std::uint32_t equalInBlock(const float* value, float wanted) {
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < kBlock; ++i) {
    bits |= value[i] == wanted ? kBits.bit[i] : 0;
  }
  return bits;
}

/// Gives the points of a block whose bit is set a label.
inline void labelBlock(std::uint32_t bits, int new_label, int* label) {
  for (std::size_t i = 0; i < kBlock; ++i) {
    label[i] = (bits & kBits.bit[i]) != 0 ? new_label : label[i];
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
    workspace_.reach.resize(Words * points_.size);
    for (std::size_t w = 0; w < Words; ++w) {
      while (left[w] != 0) {
        const std::size_t k = workspace_.clusters.size();
        const Set reach =
            growCluster(static_cast<std::uint32_t>(64 * w + lowestOne(left[w])), core);
        workspace_.clusters.push_back({0.0f, 0.0f, static_cast<std::uint32_t>(k)});
        for (std::size_t v = 0; v < Words; ++v) {
          workspace_.reach[Words * k + v] = reach[v];
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

  /// Blocks above the diagonal follow from those below.
  void compareAllPairs() {
    const float* const x = points_.x.data();
    const float* const y = points_.y.data();
    const std::size_t stride = points_.padded();
    workspace_.columns.resize(2 * Words * stride);
    std::uint32_t* const columns = workspace_.columns.data();
    for (std::size_t column = 0; column < points_.size; column += kBlock) {
      std::uint32_t* const words = columns + column / kBlock * stride;
      for (std::size_t i = column; i < points_.size; ++i) {
        words[i] = disc_.neighboursInBlock(x + column, y + column, x[i], y[i]);
      }
      std::fill(words + points_.size, words + stride, 0U);
      for (std::size_t row = column + kBlock; row < points_.size; row += kBlock) {
        transpose32(words + row, columns + row / kBlock * stride + column);
      }
    }
    const std::size_t used = (points_.size + kBlock - 1) / kBlock;
    std::fill(columns + used * stride, columns + 2 * Words * stride, 0U);
  }

  /// Turns columns into rows and counts.
  Set findCorePoints(int min_points, Clustering& result) {
    const std::size_t stride = points_.padded();
    const std::uint32_t* const columns = workspace_.columns.data();
    workspace_.rows.resize(Words * stride);
    std::uint64_t* const rows = workspace_.rows.data();
    Set core{};
    for (std::size_t w = 0; w < Words; ++w) {
      const std::size_t end = std::min(points_.size, 64 * w + 64);
      std::uint64_t bits = 0;
      for (std::size_t i = 64 * w; i < end; ++i) {
        std::uint32_t neighbours = 0;
        for (std::size_t v = 0; v < Words; ++v) {
          const std::uint64_t high = columns[(2 * v + 1) * stride + i];
          const std::uint64_t word = columns[2 * v * stride + i] | (high << 32);
          rows[Words * i + v] = word;
          neighbours += countOnes(word);
        }
        const std::uint8_t is_core = neighbours >= static_cast<std::uint32_t>(min_points) ? 1 : 0;
        result.is_core[i] = is_core;
        bits |= static_cast<std::uint64_t>(is_core) << (i % 64);
      }
      core[w] = bits;
    }
    return core;
  }

  /// The core points that are connected with `seed`, and their neighbours. Takes two points of a
  /// word at a time, which do not wait for each other.
  Set growCluster(std::uint32_t seed, const Set& core) const {
    Set reach = row(seed);
    Set grown{};
    grown[seed / 64] = std::uint64_t{1} << (seed % 64);
    for (bool any = true; any;) {
      any = false;
      for (std::size_t w = 0; w < Words; ++w) {
        const std::uint64_t frontier = reach[w] & core[w] & ~grown[w];
        if (frontier != 0) {
          any = true;
          const std::uint32_t low = lowestOne(frontier);
          const std::uint32_t high = highestOne(frontier);
          grown[w] |= (std::uint64_t{1} << low) | (std::uint64_t{1} << high);
          const Set a = row(static_cast<std::uint32_t>(64 * w) + low);
          const Set b = row(static_cast<std::uint32_t>(64 * w) + high);
          for (std::size_t v = 0; v < Words; ++v) {
            reach[v] |= a[v] | b[v];
          }
        }
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

  static std::uint32_t block(const Set& set, std::size_t b) {
    return static_cast<std::uint32_t>(set[b / 2] >> (b % 2 * 32));
  }

  std::uint32_t coresInBlock(const Set& core, const UnnumberedCluster& cluster,
                             std::size_t b) const {
    return block(reachOf(cluster.index), b) & block(core, b);
  }

  void numberBySmallestCore(const Set& core) {
    std::vector<UnnumberedCluster>& clusters = workspace_.clusters;
    const float* const x = points_.x.data();
    for (UnnumberedCluster& cluster : clusters) {
      cluster.x = std::numeric_limits<float>::infinity();
      for (std::size_t i = 0; i < points_.size; i += kBlock) {
        const std::uint32_t cores = coresInBlock(core, cluster, i / kBlock);
        cluster.x = std::min(cluster.x, smallestOfBlock(cores, x + i));
      }
    }
    numberClusters(clusters, workspace_.number);
    const auto ties = [](const UnnumberedCluster& a, const UnnumberedCluster& b) {
      return a.x == b.x;
    };
    if (std::adjacent_find(clusters.begin(), clusters.end(), ties) == clusters.end()) {
      return;
    }
    for (UnnumberedCluster& cluster : clusters) {
      cluster.y = std::numeric_limits<float>::infinity();
      for (std::size_t i = 0; i < points_.size; i += kBlock) {
        const std::uint32_t cores =
            coresInBlock(core, cluster, i / kBlock) & equalInBlock(x + i, cluster.x);
        cluster.y = std::min(cluster.y, smallestOfBlock(cores, points_.y.data() + i));
      }
    }
    numberClusters(clusters, workspace_.number);
  }

  void writeLabels(const Set& core, Clustering& result) {
    const std::vector<UnnumberedCluster>& clusters = workspace_.clusters;
    workspace_.number.assign(clusters.size(), 0);
    if (clusters.size() > 1) {
      numberBySmallestCore(core);
    }
    workspace_.label.assign(points_.padded(), kNoise);
    for (std::size_t k = 0; k < clusters.size(); ++k) {
      const Set reach = reachOf(k);
      for (std::size_t i = 0; i < points_.size; i += kBlock) {
        labelBlock(block(reach, i / kBlock), workspace_.number[k], workspace_.label.data() + i);
      }
    }
    std::copy_n(workspace_.label.begin(), points_.size, result.label.begin());
  }

  /// A border point goes to its nearest core point's cluster.
  void settle(std::uint32_t i, const Set& core, Clustering& result) const {
    Set cores = row(i);
    for (std::size_t w = 0; w < Words; ++w) {
      cores[w] &= core[w];
    }
    NearestCore nearest(disc_.squaredRadius());
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

// SPDX-License-Identifier: BSD-3-Clause
// Density clusters of many points in the plane over a grid of side radius / sqrt 2 (Gunawan, "A
// faster algorithm for DBSCAN", 2013): the points of a cell are neighbours of each other, so cells
// with MinPoints points need no count, and whole cells are joined.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include <hmcdyn/detail/bits.hpp>
#include <hmcdyn/detail/clustering_result.hpp>
#include <hmcdyn/detail/grid.hpp>
#include <hmcdyn/detail/planar_points.hpp>

namespace hmcdyn::detail {

/// Memory of clusterByGrid.
struct GridWorkspace {
  Grid grid;
  std::vector<std::uint32_t> core_end;  ///< Of each cell: its core points come first, up to here.
  CellSet unreached;                    ///< With a core point that no cluster has reached yet.
  std::vector<std::uint32_t> members;   ///< Cells of one cluster.
  std::vector<int> cluster;             ///< Of each cell: its cluster, or kNoise.
  std::vector<UnnumberedCluster> clusters;
  std::vector<int> number;  ///< Of each cluster.
};

/// The steps of clusterByGrid.
class GridClusters {
 public:
  GridClusters(const GridLayout& layout, float radius, GridWorkspace& workspace)
      : disc_(radius),
        layout_(layout),
        stride_(layout.stride()),
        grid_(workspace.grid),
        workspace_(workspace) {
    // The trash, if there, is the last cell.
    cells_ = static_cast<std::uint32_t>(grid_.cells());
    if (cells_ > 0 && grid_.key.back() == layout.trash()) {
      --cells_;
    }
  }

  void run(int min_points, Clustering& result) {
    findCorePoints(static_cast<std::uint32_t>(min_points));
    growClusters();
    number(result);
    writeLabels(result);
  }

 private:
  /// Number of the first of the five cells of a row around a cell.
  std::uint32_t rowAround(std::uint32_t cell, int row) const {
    return grid_.key[cell] + static_cast<std::uint32_t>(row * static_cast<int>(stride_) - 2);
  }

  Interval coresOf(std::uint32_t cell) const {
    return {grid_.begin[cell], workspace_.core_end[cell]};
  }

  /// Which of up to kBlock points from `first` are neighbours of (x, y).
  std::uint32_t neighboursFrom(std::uint32_t first, std::uint32_t end, float x, float y) const {
    const std::uint32_t near =
        disc_.neighboursInBlock(grid_.x.data() + first, grid_.y.data() + first, x, y);
    return end - first < kBlock ? near & ((1U << (end - first)) - 1) : near;
  }

  std::uint32_t countWithin(float x, float y, Interval points) const {
    std::uint32_t count = 0;
    for (std::uint32_t block = points.begin; block < points.end; block += kBlock) {
      count += countOnes(neighboursFrom(block, points.end, x, y));
    }
    return count;
  }

  bool anyWithin(float x, float y, Interval points) const {
    for (std::uint32_t block = points.begin; block < points.end; block += kBlock) {
      if (neighboursFrom(block, points.end, x, y) != 0) {
        return true;
      }
    }
    return false;
  }

  void findCorePoints(std::uint32_t min_points) {
    workspace_.core_end.resize(cells_);
    workspace_.unreached.clear(layout_);
    for (std::uint32_t cell = 0; cell < cells_; ++cell) {
      const Interval own{grid_.begin[cell], grid_.begin[cell + 1]};
      const std::uint32_t core_end =
          own.size() >= min_points ? own.end : coresFirst(cell, own, min_points);
      workspace_.core_end[cell] = core_end;
      workspace_.unreached.insert(grid_.key[cell], core_end > own.begin);
    }
  }

  /// Moves the core points of a cell to its front; where they end.
  std::uint32_t coresFirst(std::uint32_t cell, Interval own, std::uint32_t min_points) {
    std::array<Interval, 5> near;  // a row each, the cell's own first
    std::uint32_t candidates = 0;
    constexpr std::array<int, 5> kRows{0, 1, -1, 2, -2};
    for (std::size_t k = 0; k < kRows.size(); ++k) {
      const Interval cells = grid_.cellsFrom(rowAround(cell, kRows[k]));
      near[k] = {grid_.begin[cells.begin], grid_.begin[cells.end]};
      candidates += near[k].size();
    }
    std::uint32_t core_end = own.begin;
    if (candidates < min_points) {
      return core_end;
    }
    for (std::uint32_t i = own.begin; i < own.end; ++i) {
      std::uint32_t neighbours = 0;
      for (std::size_t k = 0; k < near.size() && neighbours < min_points; ++k) {
        neighbours += countWithin(grid_.x[i], grid_.y[i], near[k]);
      }
      if (neighbours >= min_points) {
        std::swap(grid_.x[i], grid_.x[core_end]);
        std::swap(grid_.y[i], grid_.y[core_end]);
        std::swap(grid_.point[i], grid_.point[core_end]);
        ++core_end;
      }
    }
    return core_end;
  }

  /// Whether a core point of one is a neighbour of a core point of the other.
  bool connected(Interval a, Interval b) const {
    for (std::uint32_t i = a.begin; i < a.end; ++i) {
      if (anyWithin(grid_.x[i], grid_.y[i], b)) {
        return true;
      }
    }
    return false;
  }

  /// From the first cell that no cluster has reached, time after time.
  void growClusters() {
    workspace_.cluster.assign(grid_.cells(), kNoise);
    workspace_.clusters.clear();
    for (std::size_t w = 0; w < workspace_.unreached.words(); ++w) {
      while (workspace_.unreached.word(w) != 0) {
        growFrom(static_cast<std::uint32_t>(64 * w) + lowestOne(workspace_.unreached.word(w)));
      }
    }
  }

  /// Cells of one row around a cell: a bit a column, from two before it.
  struct RowOfRing {
    int row;
    std::uint64_t columns;
  };
  static constexpr std::array<RowOfRing, 3> kNearRing{{{-1, 0b01110}, {0, 0b01010}, {1, 0b01110}}};
  static constexpr std::array<RowOfRing, 5> kFarRing{
      {{-2, 0b11111}, {-1, 0b10001}, {0, 0b10001}, {1, 0b10001}, {2, 0b11111}}};

  /// The cells around are joined first: what they lead to, cells further away need not compare.
  void growFrom(std::uint32_t number) {
    std::vector<std::uint32_t>& members = workspace_.members;
    members.clear();
    join(number);
    std::size_t next_near = 0;
    std::size_t next_far = 0;
    while (next_far < members.size()) {
      while (next_near < members.size()) {
        joinConnected(members[next_near++], kNearRing);
      }
      joinConnected(members[next_far++], kFarRing);
    }
    workspace_.clusters.push_back({std::numeric_limits<float>::infinity(), 0.0f, members.front()});
  }

  void join(std::uint32_t number) {
    const std::uint32_t cell = grid_.positionOf(number);
    workspace_.unreached.erase(number);
    workspace_.cluster[cell] = static_cast<int>(workspace_.clusters.size());
    workspace_.members.push_back(cell);
  }

  /// Joins the unreached cells of a ring around a cell that are connected with it.
  template <class Ring>
  void joinConnected(std::uint32_t cell, const Ring& ring) {
    for (const RowOfRing& of_ring : ring) {
      const std::uint32_t first = rowAround(cell, of_ring.row);
      for (std::uint64_t rest = workspace_.unreached.window(first) & of_ring.columns; rest != 0;
           rest &= rest - 1) {
        const std::uint32_t number = first + lowestOne(rest);
        if (connected(coresOf(cell), coresOf(grid_.positionOf(number)))) {
          join(number);
        }
      }
    }
  }

  /// A cluster's index is its first cell, and rows grow with x: its lexicographically smallest core
  /// point lies in that cell's row.
  void number(Clustering& result) {
    std::vector<UnnumberedCluster>& clusters = workspace_.clusters;
    result.clusters = static_cast<int>(clusters.size());
    workspace_.number.assign(clusters.size(), 0);
    if (clusters.size() > 1) {
      for (std::size_t k = 0; k < clusters.size(); ++k) {
        clusters[k] = smallestCore(static_cast<int>(k), clusters[k].index);
      }
      numberClusters(clusters, workspace_.number);
    }
    for (int& of_cell : workspace_.cluster) {
      of_cell = of_cell == kNoise ? kNoise : workspace_.number[static_cast<std::size_t>(of_cell)];
    }
  }

  UnnumberedCluster smallestCore(int cluster, std::uint32_t first_cell) const {
    UnnumberedCluster smallest{std::numeric_limits<float>::infinity(), 0.0f,
                               static_cast<std::uint32_t>(cluster)};
    const std::uint32_t row_end = (grid_.key[first_cell] / stride_ + 1) * stride_;
    for (std::uint32_t cell = first_cell; cell < cells_ && grid_.key[cell] < row_end; ++cell) {
      if (workspace_.cluster[cell] != cluster) {
        continue;
      }
      const Interval cores = coresOf(cell);
      for (std::uint32_t i = cores.begin; i < cores.end; ++i) {
        const UnnumberedCluster candidate{grid_.x[i], grid_.y[i], smallest.index};
        smallest = candidate < smallest ? candidate : smallest;
      }
    }
    return smallest;
  }

  /// As if all the points of a core cell were core points; then those that are not.
  void writeLabels(Clustering& result) {
    for (std::size_t i = 0; i < result.label.size(); ++i) {
      const int label = workspace_.cluster[grid_.cell[i]];
      result.label[i] = label;
      result.is_core[i] = label == kNoise ? 0 : 1;
    }
    for (std::uint32_t cell = 0; cell < cells_; ++cell) {
      if (workspace_.core_end[cell] < grid_.begin[cell + 1]) {
        settle(cell, result);
      }
    }
  }

  /// Points of a cell that are no core points: with their nearest core point, or noise.
  void settle(std::uint32_t cell, Clustering& result) const {
    std::array<Interval, 5> near;
    for (int row = -2; row <= 2; ++row) {
      near[static_cast<std::size_t>(row + 2)] = grid_.cellsFrom(rowAround(cell, row));
    }
    const int only = onlyClusterIn(near);
    if (only == kNoise) {
      return;
    }
    for (std::uint32_t i = workspace_.core_end[cell]; i < grid_.begin[cell + 1]; ++i) {
      int label = kNoise;
      if (only == kSeveral) {
        label = labelOfNearest(i, near);
      } else if (reachesCore(i, near)) {
        label = only;
      }
      result.label[grid_.point[i]] = label;
      result.is_core[grid_.point[i]] = 0;
    }
  }

  static constexpr int kSeveral = -2;

  /// The cluster of all the core points in these cells, kNoise without any, or kSeveral.
  int onlyClusterIn(const std::array<Interval, 5>& near) const {
    int only = kNoise;
    for (const Interval cells : near) {
      for (std::uint32_t other = cells.begin; other < cells.end; ++other) {
        const int cluster = workspace_.cluster[other];
        if (cluster != kNoise) {
          only = only == kNoise || only == cluster ? cluster : kSeveral;
        }
      }
    }
    return only;
  }

  bool reachesCore(std::uint32_t i, const std::array<Interval, 5>& near) const {
    for (const Interval cells : near) {
      for (std::uint32_t other = cells.begin; other < cells.end; ++other) {
        if (anyWithin(grid_.x[i], grid_.y[i], coresOf(other))) {
          return true;
        }
      }
    }
    return false;
  }

  int labelOfNearest(std::uint32_t i, const std::array<Interval, 5>& near) const {
    NearestCore nearest(disc_.squaredRadius());
    for (const Interval cells : near) {
      for (std::uint32_t other = cells.begin; other < cells.end; ++other) {
        const Interval cores = coresOf(other);
        for (std::uint32_t j = cores.begin; j < cores.end; ++j) {
          nearest.offer(disc_.power(grid_.x[j] - grid_.x[i], grid_.y[j] - grid_.y[i]), grid_.x[j],
                        grid_.y[j], other);
        }
      }
    }
    return nearest.found ? workspace_.cluster[nearest.index] : kNoise;
  }

  Disc disc_;
  GridLayout layout_;
  std::uint32_t stride_;
  std::uint32_t cells_ = 0;
  Grid& grid_;
  GridWorkspace& workspace_;
};

/// Clusters the points of a layout with rows; labels and flags of `result` have their size already.
inline void clusterByGrid(const PlanarPoints& points, const GridLayout& layout, float radius,
                          int min_points, GridWorkspace& workspace, Clustering& result) {
  workspace.grid.fill(points, layout);
  GridClusters(layout, radius, workspace).run(min_points, result);
}

}  // namespace hmcdyn::detail

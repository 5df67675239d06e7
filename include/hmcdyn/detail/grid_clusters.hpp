// SPDX-License-Identifier: BSD-3-Clause
// Density clusters of many points in the plane over a grid of side radius / sqrt 2 (Gunawan, "A
// faster algorithm for DBSCAN", 2013): the points of a cell are neighbours of each other, so cells
// with MinPoints points need no count, and whole cells are united.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include <hmcdyn/detail/clustering_result.hpp>
#include <hmcdyn/detail/grid.hpp>
#include <hmcdyn/detail/planar_points.hpp>
#include <hmcdyn/detail/union_find.hpp>

namespace hmcdyn::detail {

/// Memory of clusterByGrid.
struct GridWorkspace {
  Grid grid;
  std::vector<std::uint32_t> core_end;  ///< Of each cell: its core points come first, up to here.
  UnionFind sets;                       ///< Of cells.
  std::vector<UnnumberedCluster> clusters;
  std::vector<int> number;  ///< By root cell.
};

/// The steps of clusterByGrid.
class GridClusters {
 public:
  GridClusters(const GridLayout& layout, float radius, GridWorkspace& workspace)
      : disc_(radius),
        stride_(layout.stride()),
        grid_(workspace.grid),
        core_end_(workspace.core_end),
        sets_(workspace.sets),
        workspace_(workspace) {
    // The trash, if there, is the last cell.
    cells_ = static_cast<std::uint32_t>(grid_.cells());
    if (cells_ > 0 && grid_.key.back() == layout.trash()) {
      --cells_;
    }
  }

  void run(int min_points, Clustering& result) {
    findCorePoints(static_cast<std::uint32_t>(min_points));
    uniteCells();
    number(result);
    writeLabels(result);
  }

 private:
  /// Cells with a row offset of `row` and column offsets from `from` to `to`.
  Interval window(std::uint32_t cell, int row, int from, int to) const {
    const std::uint32_t first =
        grid_.key[cell] + static_cast<std::uint32_t>(row * static_cast<int>(stride_) + from);
    return grid_.cellsIn(first, static_cast<std::uint32_t>(to - from + 1));
  }

  std::uint32_t countWithin(float x, float y, Interval points) const {
    std::array<std::uint32_t, kLanes> count{};
    for (std::uint32_t block = points.begin; block < points.end; block += kLanes) {
      const std::uint32_t left = points.end - block;
      for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
        const bool within = disc_.contains(grid_.x[block + lane] - x, grid_.y[block + lane] - y);
        count[lane] += (within ? 1U : 0U) & (lane < left ? 1U : 0U);
      }
    }
    std::uint32_t sum = 0;
    for (const std::uint32_t of_lane : count) {
      sum += of_lane;
    }
    return sum;
  }

  void findCorePoints(std::uint32_t min_points) {
    core_end_.resize(cells_);
    for (std::uint32_t cell = 0; cell < cells_; ++cell) {
      const Interval own{grid_.begin[cell], grid_.begin[cell + 1]};
      core_end_[cell] = own.size() >= min_points ? own.end : coresFirst(cell, own, min_points);
    }
  }

  /// Moves the core points of a cell to its front; where they end.
  std::uint32_t coresFirst(std::uint32_t cell, Interval own, std::uint32_t min_points) {
    std::array<Interval, 5> near;  // a row each, the cell's own first
    std::uint32_t candidates = 0;
    constexpr std::array<int, 5> kRows{0, 1, -1, 2, -2};
    for (std::size_t k = 0; k < kRows.size(); ++k) {
      const Interval cells = window(cell, kRows[k], -2, 2);
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

  Interval coresOf(std::uint32_t cell) const { return {grid_.begin[cell], core_end_[cell]}; }

  /// Whether a core point of one is a neighbour of a core point of the other.
  bool connected(Interval a, Interval b) const {
    for (std::uint32_t i = a.begin; i < a.end; ++i) {
      for (std::uint32_t j = b.begin; j < b.end; ++j) {
        if (disc_.contains(grid_.x[i] - grid_.x[j], grid_.y[i] - grid_.y[j])) {
          return true;
        }
      }
    }
    return false;
  }

  void uniteWith(std::uint32_t cell, Interval others) {
    const Interval cores = coresOf(cell);
    for (std::uint32_t other = others.begin; other < others.end; ++other) {
      if (sets_.find(cell) != sets_.find(other) && connected(cores, coresOf(other))) {
        sets_.unite(cell, other);
      }
    }
  }

  /// Nearest cells first: what they unite, cells further away need not compare.
  void uniteCells() {
    sets_.reset(cells_);
    for (std::uint32_t cell = 0; cell < cells_; ++cell) {
      if (coresOf(cell).size() > 0) {
        uniteWith(cell, window(cell, 0, 1, 1));
        uniteWith(cell, window(cell, 1, -1, 1));
      }
    }
    for (std::uint32_t cell = 0; cell < cells_; ++cell) {
      if (coresOf(cell).size() > 0) {
        uniteWith(cell, window(cell, 0, 2, 2));
        uniteWith(cell, window(cell, 1, -2, 2));
        uniteWith(cell, window(cell, 2, -2, 2));
      }
    }
  }

  /// A cluster's root is its first cell, and rows grow with x: its lexicographically smallest core
  /// point lies in that cell's row.
  void number(Clustering& result) {
    workspace_.number.resize(cells_);
    std::vector<UnnumberedCluster>& clusters = workspace_.clusters;
    clusters.clear();
    for (std::uint32_t cell = 0; cell < cells_; ++cell) {
      if (coresOf(cell).size() > 0 && sets_.find(cell) == cell) {
        clusters.push_back({std::numeric_limits<float>::infinity(), 0.0f, cell});
      }
    }
    result.clusters = static_cast<int>(clusters.size());
    if (clusters.size() > 1) {
      for (UnnumberedCluster& cluster : clusters) {
        findSmallestCore(cluster);
      }
    }
    numberClusters(clusters, workspace_.number);
  }

  void findSmallestCore(UnnumberedCluster& cluster) {
    const std::uint32_t root = cluster.index;
    const std::uint32_t row = grid_.key[root] / stride_;
    const std::uint32_t row_end = (row + 1) * stride_;
    for (std::uint32_t cell = root; cell < cells_ && grid_.key[cell] < row_end; ++cell) {
      const Interval cores = coresOf(cell);
      if (sets_.find(cell) != root) {
        continue;
      }
      for (std::uint32_t i = cores.begin; i < cores.end; ++i) {
        const UnnumberedCluster candidate{grid_.x[i], grid_.y[i], root};
        cluster = candidate < cluster ? candidate : cluster;
      }
    }
  }

  void writeLabels(Clustering& result) {
    for (std::uint32_t cell = 0; cell < cells_; ++cell) {
      const Interval cores = coresOf(cell);
      if (cores.size() > 0) {
        const int label = workspace_.number[sets_.find(cell)];
        for (std::uint32_t i = cores.begin; i < cores.end; ++i) {
          result.label[grid_.point[i]] = label;
          result.is_core[grid_.point[i]] = 1;
        }
      }
      if (core_end_[cell] < grid_.begin[cell + 1]) {
        settle(cell, result);
      }
    }
    for (std::size_t i = grid_.begin[cells_]; i < grid_.point.size(); ++i) {
      result.label[grid_.point[i]] = kNoise;
      result.is_core[grid_.point[i]] = 0;
    }
  }

  /// Points of a cell that are no core points: with their nearest core point, or noise.
  void settle(std::uint32_t cell, Clustering& result) {
    std::array<Interval, 5> near;
    for (int row = -2; row <= 2; ++row) {
      near[static_cast<std::size_t>(row + 2)] = window(cell, row, -2, 2);
    }
    const std::uint32_t only = onlyClusterIn(near);
    for (std::uint32_t i = core_end_[cell]; i < grid_.begin[cell + 1]; ++i) {
      int label = kNoise;
      if (only == kSeveral) {
        label = labelOfNearest(i, near);
      } else if (only != kNone && reachesCore(i, near)) {
        label = workspace_.number[only];
      }
      result.label[grid_.point[i]] = label;
      result.is_core[grid_.point[i]] = 0;
    }
  }

  static constexpr std::uint32_t kNone = ~std::uint32_t{0};
  static constexpr std::uint32_t kSeveral = kNone - 1;

  /// The cluster (by root) of all the core points in these cells, kNone, or kSeveral.
  std::uint32_t onlyClusterIn(const std::array<Interval, 5>& near) {
    std::uint32_t only = kNone;
    for (const Interval cells : near) {
      for (std::uint32_t other = cells.begin; other < cells.end; ++other) {
        if (coresOf(other).size() > 0) {
          const std::uint32_t root = sets_.find(other);
          only = only == kNone || only == root ? root : kSeveral;
        }
      }
    }
    return only;
  }

  bool reachesCore(std::uint32_t i, const std::array<Interval, 5>& near) const {
    for (const Interval cells : near) {
      for (std::uint32_t other = cells.begin; other < cells.end; ++other) {
        if (connected({i, i + 1}, coresOf(other))) {
          return true;
        }
      }
    }
    return false;
  }

  int labelOfNearest(std::uint32_t i, const std::array<Interval, 5>& near) {
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
    return nearest.found ? workspace_.number[sets_.find(nearest.index)] : kNoise;
  }

  Disc disc_;
  std::uint32_t stride_;
  std::uint32_t cells_ = 0;
  Grid& grid_;
  std::vector<std::uint32_t>& core_end_;
  UnionFind& sets_;
  GridWorkspace& workspace_;
};

/// Clusters the points of a layout with rows; labels and flags of `result` have their size already.
inline void clusterByGrid(const PlanarPoints& points, const GridLayout& layout, float radius,
                          int min_points, GridWorkspace& workspace, Clustering& result) {
  workspace.grid.fill(points, layout);
  GridClusters(layout, radius, workspace).run(min_points, result);
}

}  // namespace hmcdyn::detail

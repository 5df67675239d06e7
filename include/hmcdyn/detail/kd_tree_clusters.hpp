// SPDX-License-Identifier: BSD-3-Clause
// Density clusters in any number of dimensions under any Minkowski distance, over a kd-tree.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <Eigen/Core>

#include <hmcdyn/detail/clustering_result.hpp>
#include <hmcdyn/detail/kd_tree.hpp>
#include <hmcdyn/detail/minkowski.hpp>
#include <hmcdyn/detail/neighbour_cells.hpp>
#include <hmcdyn/detail/union_find.hpp>

namespace hmcdyn::detail {

/// Different points whose neighbours are found by a kd-tree.
class NeighbourSearch {
 public:
  /// @param points finite, D-by-N; outlives this, as the ball does.
  NeighbourSearch(const Eigen::MatrixXf& points, const MinkowskiBall& ball)
      : points_(points),
        ball_(ball),
        tree_(points),
        search_(ball.enclosingSquaredRadius(points.rows())) {}

  /// Calls `visit(j, power)` for the neighbours of point i, itself too, until it returns false.
  template <class Visit>
  void visitNeighbours(std::size_t i, Visit&& visit) const {
    tree_.visitWithin(column(i), search_, [&](std::uint32_t j) {
      const float power = ball_.power(column(i), column(j), points_.rows());
      return !ball_.contains(power) || visit(j, power);
    });
  }

 private:
  const float* column(std::size_t i) const {
    return points_.col(static_cast<Eigen::Index>(i)).data();
  }

  const Eigen::MatrixXf& points_;
  const MinkowskiBall& ball_;
  KdTree tree_;
  float search_;
};

/// Marks the core points; those that are marked already are.
inline void findCores(const NeighbourSearch& search, const std::vector<int>& times, int min_points,
                      std::vector<std::uint8_t>& is_core) {
  for (std::size_t i = 0; i < is_core.size(); ++i) {
    std::int64_t neighbours = 0;
    if (is_core[i] == 0) {
      search.visitNeighbours(i, [&](std::uint32_t j, float) {
        neighbours += times[j];
        return neighbours < min_points;
      });
      is_core[i] = neighbours >= min_points ? 1 : 0;
    }
  }
}

/// The nearest core point among a point's neighbours, the smallest of equally near ones; -1 where
/// there is none.
inline std::int64_t nearestCore(const NeighbourSearch& search, std::size_t i,
                                const std::vector<std::uint8_t>& is_core) {
  float nearest = std::numeric_limits<float>::infinity();
  std::int64_t core = -1;
  search.visitNeighbours(i, [&](std::uint32_t j, float power) {
    if (is_core[j] != 0 && (power < nearest || (power == nearest && j < core))) {
      nearest = power;
      core = j;
    }
    return true;
  });
  return core;
}

/// Clusters finite points whose columns are in lexicographic order: ties then fall to the smaller
/// index, and clusters come out numbered by their smallest core point. No two columns are equal:
/// `times` says how many points lie there, so that duplicates cost no more than one of them.
inline Clustering clusterSorted(const Eigen::MatrixXf& points, const std::vector<int>& times,
                                const MinkowskiBall& ball, int min_points) {
  const auto n = static_cast<std::size_t>(points.cols());
  const NeighbourSearch search(points, ball);
  NeighbourCells cells(points, ball);
  Clustering result;
  result.label.assign(n, kNoise);
  result.is_core.assign(n, 0);
  if (cells.areWorthIt()) {
    cells.markFull(times, min_points, result.is_core);
  }
  findCores(search, times, min_points, result.is_core);

  UnionFind sets;
  sets.reset(n);
  if (cells.areWorthIt()) {
    cells.unite(result.is_core, sets);
  }
  std::vector<std::int64_t> nearest_core(n, -1);
  for (std::size_t i = 0; i < n; ++i) {
    if (result.is_core[i] == 0) {
      nearest_core[i] = nearestCore(search, i, result.is_core);
    } else if (!cells.areWorthIt()) {
      search.visitNeighbours(i, [&](std::uint32_t j, float) {
        if (result.is_core[j] != 0) {
          sets.unite(static_cast<std::uint32_t>(i), j);
        }
        return true;
      });
    }
  }

  for (std::size_t i = 0; i < n; ++i) {
    if (result.is_core[i] != 0) {
      const std::uint32_t root = sets.find(static_cast<std::uint32_t>(i));
      result.label[i] = root == i ? result.clusters++ : result.label[root];
    }
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (nearest_core[i] >= 0) {
      result.label[i] = result.label[static_cast<std::size_t>(nearest_core[i])];
    }
  }
  return result;
}

/// Clusters N points, a column each; labels and flags of `result` have their size already. Unlike
/// the other backends, takes its memory anew each time.
template <class Matrix>
void clusterByKdTree(const Matrix& points, const MinkowskiBall& ball, int min_points,
                     Clustering& result) {
  std::vector<Eigen::Index> order;
  order.reserve(static_cast<std::size_t>(points.cols()));
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    if (points.col(i).allFinite()) {
      order.push_back(i);
    }
  }
  std::sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
    for (Eigen::Index k = 0; k < points.rows(); ++k) {
      if (points(k, a) != points(k, b)) {
        return points(k, a) < points(k, b);
      }
    }
    return a < b;
  });
  std::fill(result.label.begin(), result.label.end(), kNoise);
  std::fill(result.is_core.begin(), result.is_core.end(), std::uint8_t{0});
  result.clusters = 0;
  if (order.empty()) {
    return;
  }
  // Of equal points one, and how many there are.
  Eigen::MatrixXf different(points.rows(), static_cast<Eigen::Index>(order.size()));
  std::vector<int> times;
  std::vector<std::size_t> place(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i == 0 || points.col(order[i]) != points.col(order[i - 1])) {
      different.col(static_cast<Eigen::Index>(times.size())) = points.col(order[i]);
      times.push_back(0);
    }
    ++times.back();
    place[i] = times.size() - 1;
  }
  different.conservativeResize(Eigen::NoChange, static_cast<Eigen::Index>(times.size()));
  const Clustering of_different = clusterSorted(different, times, ball, min_points);
  result.clusters = of_different.clusters;
  for (std::size_t i = 0; i < order.size(); ++i) {
    result.label[static_cast<std::size_t>(order[i])] = of_different.label[place[i]];
    result.is_core[static_cast<std::size_t>(order[i])] = of_different.is_core[place[i]];
  }
}

}  // namespace hmcdyn::detail

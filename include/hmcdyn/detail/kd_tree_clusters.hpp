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
#include <hmcdyn/detail/union_find.hpp>

namespace hmcdyn::detail {

/// Clusters finite points whose columns are in lexicographic order: ties then fall to the smaller
/// index, and clusters come out numbered by their smallest core point. No two columns are equal:
/// `times` says how many points lie there, so that duplicates cost no more than one of them.
inline Clustering clusterSorted(const Eigen::MatrixXf& points, const std::vector<int>& times,
                                const MinkowskiBall& ball, int min_points) {
  const auto n = static_cast<std::size_t>(points.cols());
  const Eigen::Index dimensions = points.rows();
  const KdTree tree(points);
  const float search = ball.enclosingSquaredRadius(dimensions);
  const auto column = [&](std::size_t i) {
    return points.col(static_cast<Eigen::Index>(i)).data();
  };
  const auto visitNeighbours = [&](std::size_t i, auto&& visit) {
    tree.visitWithin(column(i), search, [&](std::uint32_t j) {
      const float power = ball.power(column(i), column(j), dimensions);
      if (ball.contains(power)) {
        visit(j, power);
      }
    });
  };

  Clustering result;
  result.label.assign(n, kNoise);
  result.is_core.assign(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    std::int64_t neighbours = 0;
    visitNeighbours(i, [&](std::uint32_t j, float) { neighbours += times[j]; });
    result.is_core[i] = neighbours >= min_points ? 1 : 0;
  }

  UnionFind sets;
  sets.reset(n);
  std::vector<std::int64_t> nearest_core(n, -1);
  for (std::size_t i = 0; i < n; ++i) {
    float nearest = std::numeric_limits<float>::infinity();
    visitNeighbours(i, [&](std::uint32_t j, float power) {
      if (result.is_core[j] == 0) {
        return;
      }
      if (result.is_core[i] != 0) {
        sets.unite(static_cast<std::uint32_t>(i), j);
      } else if (power < nearest || (power == nearest && j < nearest_core[i])) {
        nearest = power;
        nearest_core[i] = j;
      }
    });
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

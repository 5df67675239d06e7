// SPDX-License-Identifier: BSD-3-Clause
// Step 5: hierarchical multidimensional clustering (HMC), density clusters over depth and distance.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include <hmcdyn/detail/kd_tree.hpp>
#include <hmcdyn/detail/minkowski.hpp>
#include <hmcdyn/types.hpp>

namespace hmcdyn {

/// The label of a point that belongs to no cluster.
inline constexpr int kNoise = -1;

/// The paper fixes neither scales, radius nor MinPoints; docs/parameters.md has the sweep that led
/// to these defaults.
struct ClusteringOptions {
  float depth_scale = 1.0f;      ///< s_z: weight of a depth difference (1/m).
  float distance_scale = 0.05f;  ///< s_d: weight of a distance difference (1/px).
  float epsilon = 0.1f;          ///< d_eps: neighbourhood radius, after scaling (no unit).
  int min_points = 5;            ///< MinPoints: points in a core point's neighbourhood, itself too.
  float order = 2.0f;            ///< p of the Minkowski distance, eq. 6; 1 to 100, or infinite.
};

/// @throws std::invalid_argument naming the first option out of range.
inline void checkOptions(const ClusteringOptions& options) {
  const auto require = [](bool good, const char* name, float value, const char* expected) {
    if (!good) {
      throw std::invalid_argument(std::string("ClusteringOptions::") + name + " is " +
                                  std::to_string(value) + "; expected " + expected);
    }
  };
  require(options.depth_scale > 0.0f && std::isfinite(options.depth_scale), "depth_scale",
          options.depth_scale, "a finite value > 0 (1/m)");
  require(options.distance_scale > 0.0f && std::isfinite(options.distance_scale), "distance_scale",
          options.distance_scale, "a finite value > 0 (1/px)");
  // Beyond, squares and higher powers leave the range of float.
  require(options.epsilon >= 1e-15f && options.epsilon <= 1e15f, "epsilon", options.epsilon,
          "a value in [1e-15, 1e15]");
  require(options.min_points >= 1, "min_points", static_cast<float>(options.min_points),
          "a count >= 1");
  require((options.order >= 1.0f && options.order <= 100.0f) ||
              (std::isinf(options.order) && options.order > 0.0f),
          "order", options.order, "a value in [1, 100], or infinity");
}

/// Clusters of N points.
struct Clustering {
  std::vector<int> label;             ///< N labels: 0 .. clusters - 1, or kNoise.
  std::vector<std::uint8_t> is_core;  ///< N flags: 1 for a core point.
  int clusters = 0;                   ///< Number of clusters.
};

namespace detail {

/// Disjoint sets with path halving; the smaller index is the root, so the result does not depend on
/// the order of the unions.
class UnionFind {
 public:
  explicit UnionFind(std::size_t n) : parent_(n) {
    std::iota(parent_.begin(), parent_.end(), std::uint32_t{0});
  }
  std::uint32_t find(std::uint32_t i) {
    while (parent_[i] != i) {
      parent_[i] = parent_[parent_[i]];
      i = parent_[i];
    }
    return i;
  }
  void unite(std::uint32_t a, std::uint32_t b) {
    a = find(a);
    b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

/// Clusters finite points whose columns are in lexicographic order: ties then fall to the smaller
/// index, and clusters come out numbered by their smallest core point.
inline Clustering clusterSorted(const Eigen::MatrixXf& points, const MinkowskiBall& ball,
                                int min_points) {
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
    int neighbours = 0;
    visitNeighbours(i, [&](std::uint32_t, float) { ++neighbours; });
    result.is_core[i] = neighbours >= min_points ? 1 : 0;
  }

  UnionFind sets(n);
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

}  // namespace detail

/// Density clustering (DBSCAN; Ester, Kriegel, Sander, Xu 1996) of N points in D dimensions under
/// the Minkowski distance of eq. 6; depth_scale and distance_scale are not used.
///
/// Two points are neighbours when their distance is at most epsilon. A core point has at least
/// min_points neighbours, itself counted. Core points that are neighbours share a cluster. A border
/// point (no core point, but a neighbour of one) goes to the cluster of its nearest core point; at
/// equal distance, of the one that is smaller in lexicographic order of the coordinates. The rest,
/// and every point with a coordinate that is not finite, is noise. Clusters are numbered by their
/// lexicographically smallest core point. So labels do not depend on the order of the points.
///
/// @param points D-by-N, a point a column.
/// @throws std::invalid_argument when an option is out of range, or points have no coordinates.
inline Clustering densityClusters(const Eigen::Ref<const Eigen::MatrixXf>& points,
                                  const ClusteringOptions& options = {}) {
  checkOptions(options);
  const auto n = static_cast<std::size_t>(points.cols());
  if (points.rows() == 0 && n > 0) {
    throw std::invalid_argument("densityClusters: " + std::to_string(n) +
                                " points of 0 coordinates; expected at least 1");
  }
  std::vector<Eigen::Index> order;
  order.reserve(n);
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

  Clustering result;
  result.label.assign(n, kNoise);
  result.is_core.assign(n, 0);
  if (order.empty()) {
    return result;
  }
  Eigen::MatrixXf sorted(points.rows(), static_cast<Eigen::Index>(order.size()));
  for (std::size_t i = 0; i < order.size(); ++i) {
    sorted.col(static_cast<Eigen::Index>(i)) = points.col(order[i]);
  }
  const Clustering of_sorted = detail::clusterSorted(
      sorted, detail::MinkowskiBall(options.order, options.epsilon), options.min_points);
  result.clusters = of_sorted.clusters;
  for (std::size_t i = 0; i < order.size(); ++i) {
    result.label[static_cast<std::size_t>(order[i])] = of_sorted.label[i];
    result.is_core[static_cast<std::size_t>(order[i])] = of_sorted.is_core[i];
  }
  return result;
}

/// The HMC step (section III-B): density clusters of the points of one box over
/// (s_z depth, s_d distance), numbered from the nearest. Points without a usable depth or without a
/// distance are noise.
///
/// @param depth N depths (m). @param distance N distances (px).
/// @throws std::invalid_argument when sizes differ or an option is out of range.
inline Clustering clusterBox(Span<const float> depth, Span<const float> distance,
                             const ClusteringOptions& options = {}) {
  if (depth.size() != distance.size()) {
    throw std::invalid_argument("clusterBox: " + std::to_string(depth.size()) + " depths, but " +
                                std::to_string(distance.size()) +
                                " distances; expected equal sizes");
  }
  Eigen::MatrixXf points(2, static_cast<Eigen::Index>(depth.size()));
  for (std::size_t i = 0; i < depth.size(); ++i) {
    points.col(static_cast<Eigen::Index>(i))
        << (hasDepth(depth[i]) ? options.depth_scale * depth[i] : kNaN),
        options.distance_scale * distance[i];
  }
  return densityClusters(points, options);
}

}  // namespace hmcdyn

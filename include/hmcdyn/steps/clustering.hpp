// SPDX-License-Identifier: BSD-3-Clause
// Step 5: hierarchical multidimensional clustering (HMC), density clusters over depth and distance.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include <hmcdyn/detail/bit_set_clusters.hpp>
#include <hmcdyn/detail/clustering_result.hpp>
#include <hmcdyn/detail/grid_clusters.hpp>
#include <hmcdyn/detail/kd_tree_clusters.hpp>
#include <hmcdyn/detail/minkowski.hpp>
#include <hmcdyn/detail/planar_points.hpp>
#include <hmcdyn/detail/requirements.hpp>
#include <hmcdyn/types.hpp>

namespace hmcdyn {

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

/// Memory that densityClusters and clusterBox reuse from call to call, with the last result.
struct ClusteringWorkspace {
  Clustering result;                 ///< Of the last call.
  detail::PlanarPoints points;       ///< Scaled coordinates.
  detail::BitSetWorkspace bit_sets;  ///< For few points.
  detail::GridWorkspace grid;        ///< For many points.
};

namespace detail {

/// Clusters workspace.points for p = 2; the backends agree, so which one is a matter of time.
inline const Clustering& clusterPlanar(const ClusteringOptions& options,
                                       ClusteringWorkspace& workspace) {
  const PlanarPoints& points = workspace.points;
  Clustering& result = workspace.result;
  result.label.resize(points.size);
  result.is_core.resize(points.size);
  if (points.size <= kBitSetCapacity) {
    clusterByBitSets(points, options.epsilon, options.min_points, workspace.bit_sets, result);
    return result;
  }
  const GridLayout layout = layOutGrid(points, options.epsilon);
  if (layout.rows > 0) {
    clusterByGrid(points, layout, options.epsilon, options.min_points, workspace.grid, result);
    return result;
  }
  // Scattered so widely that a grid would be mostly empty, or not finite.
  Eigen::Matrix2Xf columns(2, static_cast<Eigen::Index>(points.size));
  columns.row(0) = Eigen::Map<const Eigen::RowVectorXf>(points.x.data(), columns.cols());
  columns.row(1) = Eigen::Map<const Eigen::RowVectorXf>(points.y.data(), columns.cols());
  clusterByKdTree(columns, MinkowskiBall(2.0f, options.epsilon), options.min_points, result);
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
/// Takes O(N) time for evenly spread points in the plane with p = 2, else O(N log N), also where
/// neighbourhoods hold most of the points: those of a cell in which all are neighbours are taken
/// together. Only in many dimensions, where few share a cell, that is O(M^2) for M different
/// points.
///
/// @param points D-by-N, a point a column.
/// @param workspace keeps the memory and the result; valid until the next call with it. For points
/// in the plane with p = 2, a call allocates nothing once the workspace has seen its like.
/// @throws std::invalid_argument when an option is out of range, or points have no coordinates.
inline const Clustering& densityClusters(const Eigen::Ref<const Eigen::MatrixXf>& points,
                                         const ClusteringOptions& options,
                                         ClusteringWorkspace& workspace) {
  checkOptions(options);
  const auto n = static_cast<std::size_t>(points.cols());
  if (points.rows() == 0 && n > 0) {
    throw std::invalid_argument("densityClusters: " + std::to_string(n) +
                                " points of 0 coordinates; expected at least 1");
  }
  if (points.rows() != 2 || options.order != 2.0f) {
    workspace.result.label.resize(n);
    workspace.result.is_core.resize(n);
    detail::clusterByKdTree(points, detail::MinkowskiBall(options.order, options.epsilon),
                            options.min_points, workspace.result);
    return workspace.result;
  }
  workspace.points.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    const bool finite = std::isfinite(points(0, column)) && std::isfinite(points(1, column));
    workspace.points.x[i] = finite ? points(0, column) : kNaN;
    workspace.points.y[i] = finite ? points(1, column) : kNaN;
  }
  return detail::clusterPlanar(options, workspace);
}

/// The same without a workspace.
inline Clustering densityClusters(const Eigen::Ref<const Eigen::MatrixXf>& points,
                                  const ClusteringOptions& options = {}) {
  ClusteringWorkspace workspace;
  densityClusters(points, options, workspace);
  return std::move(workspace.result);
}

/// The HMC step (section III-B): density clusters of the points of one box over
/// (s_z depth, s_d distance), numbered from the nearest. Points without a usable depth or without a
/// distance are noise.
///
/// @param depth N depths (m). @param distance N distances (px).
/// @param workspace keeps the memory and the result; valid until the next call with it.
/// @throws std::invalid_argument when sizes differ or an option is out of range.
inline const Clustering& clusterBox(Span<const float> depth, Span<const float> distance,
                                    const ClusteringOptions& options,
                                    ClusteringWorkspace& workspace) {
  if (depth.size() != distance.size()) {
    throw std::invalid_argument("clusterBox: " + std::to_string(depth.size()) + " depths, but " +
                                std::to_string(distance.size()) +
                                " distances; expected equal sizes");
  }
  checkOptions(options);
  constexpr float kLargest = std::numeric_limits<float>::max();
  workspace.points.resize(depth.size());
  float* const x = workspace.points.x.data();
  float* const y = workspace.points.y.data();
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const float z = options.depth_scale * depth[i];
    const float d = options.distance_scale * distance[i];
    const float metres = depth[i];
    const float size = std::abs(d);
    // Without a branch. NOLINTBEGIN(readability-implicit-bool-conversion)
    const bool usable = (metres > 0.0f) & (z <= kLargest) & (size <= kLargest);
    // NOLINTEND(readability-implicit-bool-conversion)
    x[i] = usable ? z : kNaN;
    y[i] = usable ? d : kNaN;
  }
  if (options.order == 2.0f) {
    return detail::clusterPlanar(options, workspace);
  }
  Eigen::MatrixXf columns(2, static_cast<Eigen::Index>(depth.size()));
  for (std::size_t i = 0; i < depth.size(); ++i) {
    columns.col(static_cast<Eigen::Index>(i)) << x[i], y[i];
  }
  return densityClusters(columns, options, workspace);
}

/// The same without a workspace.
inline Clustering clusterBox(Span<const float> depth, Span<const float> distance,
                             const ClusteringOptions& options = {}) {
  ClusteringWorkspace workspace;
  clusterBox(depth, distance, options, workspace);
  return std::move(workspace.result);
}

}  // namespace hmcdyn

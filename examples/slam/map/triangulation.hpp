// SPDX-License-Identifier: BSD-3-Clause
// Map points from key points without a depth: two key frames that see one give its place.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "slam/map/map.hpp"

namespace hmcdyn::slam {

struct TriangulationOptions {
  std::size_t neighbours = 4;  ///< Key frames that a new one is compared with.
  int max_distance = 50;       ///< Descriptors farther apart do not match (bits of 256).
  float max_ratio = 0.8f;      ///< Best to second best distance along the epipolar line.
  double max_epipolar = 2.0;   ///< Distance from the epipolar line (sigma).
  double min_parallax = 0.02;  ///< Angle between the rays (rad): less, and the distance is unknown.
  double chi2 = 5.991;         ///< Squared reprojection error in both images (sigma^2): 95 %.
};

/// A point that two key frames see, neither with a depth.
struct TriangulatedPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< World (m).
  Observation first;                                   ///< In the latest key frame.
  Observation second;                                  ///< In a neighbour.
};

/// Where the rays of two pixels meet: the middle between them at their closest. NaN for parallel
/// rays.
/// @param first, second unit directions in the world. @param from, to camera centres (m).
Eigen::Vector3d midpoint(const Eigen::Vector3d& from, const Eigen::Vector3d& first,
                         const Eigen::Vector3d& to, const Eigen::Vector3d& second);

/// Matches the key points of the latest key frame that have neither depth nor map point, and that
/// stand still (mayEnterMap()), along their epipolar lines with those of its neighbours.
/// One-to-one within the latest key frame.
std::vector<TriangulatedPoint> triangulateNewPoints(const Map& map,
                                                    const TriangulationOptions& options);

}  // namespace hmcdyn::slam

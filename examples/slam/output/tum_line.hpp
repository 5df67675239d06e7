// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include <Eigen/Geometry>

namespace hmcdyn::slam {

/// When and where a camera was.
struct StampedPose {
  double timestamp = 0.0;                                               ///< s.
  Eigen::Isometry3d camera_from_world = Eigen::Isometry3d::Identity();  ///< Translation in m.
};

/// A line of a TUM trajectory, with its end: `timestamp tx ty tz qx qy qz qw`, the camera's pose in
/// the world; microseconds and nanometres.
/// @param timestamp s. @param camera_from_world translation in m; written is its inverse.
/// @throws std::invalid_argument where the stamp or the pose is not finite.
std::string tumLine(double timestamp, const Eigen::Isometry3d& camera_from_world);

}  // namespace hmcdyn::slam

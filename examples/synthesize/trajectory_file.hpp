// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

#include <Eigen/Geometry>

#include "synthesize/rooms.hpp"
#include "synthesize/scene.hpp"

namespace hmcdyn::synthesize {

struct StampedPose {
  double time = 0.0;  ///< (s)
  Eigen::Isometry3d camera_to_world = Eigen::Isometry3d::Identity();
};

/// Reads "timestamp tx ty tz qx qy qz qw" lines; lines that are empty, start with # or repeat the
/// time stamp before are skipped.
/// @throws std::runtime_error with file and line for a file that cannot be read, a line that is
///   not eight finite numbers, a quaternion without length, or times that fall.
std::vector<StampedPose> readTrajectory(const std::filesystem::path& path);

/// A camera path through recorded poses. The recording's world is moved by one rigid transform, so
/// that its mean position and mean direction become those of `view`; time 0 is the first pose.
/// Poses are smoothed over some 20 ms, which takes away a motion capture's noise of 0.1 mm.
/// @param seconds how long the path must last.
/// @throws std::runtime_error if the recording is shorter, or leaves `bounds`.
CameraPath pathFromFile(const std::filesystem::path& path, const Eigen::Isometry3d& view,
                        double seconds, const RoomBounds& bounds);

}  // namespace hmcdyn::synthesize

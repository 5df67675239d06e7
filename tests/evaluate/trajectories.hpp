// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <random>

#include <Eigen/Geometry>

#include "evaluate/trajectory.hpp"

namespace hmcdyn::evaluate::test {

inline StampedPose stampedPose(
    double time, const Eigen::Vector3d& position,
    const Eigen::Quaterniond& rotation = Eigen::Quaterniond::Identity()) {
  StampedPose stamped;
  stamped.timestamp = time;
  stamped.pose.linear() = rotation.toRotationMatrix();
  stamped.pose.translation() = position;
  return stamped;
}

/// `count` poses, 1/10 s apart from time 0, along x at `speed` (m/s), turning about z at
/// `turn_rate` (rad/s).
inline Trajectory straightLine(std::size_t count, double speed, double turn_rate = 0.0) {
  Trajectory trajectory;
  for (std::size_t i = 0; i < count; ++i) {
    const double time = static_cast<double>(i) / 10.0;
    const Eigen::Quaterniond rotation(
        Eigen::AngleAxisd(turn_rate * time, Eigen::Vector3d::UnitZ()));
    trajectory.push_back(stampedPose(time, {speed * time, 0.0, 0.0}, rotation));
  }
  return trajectory;
}

/// `count` poses, 1/10 s apart, along a helix: turns in all directions, lies in no plane.
inline Trajectory helix(std::size_t count) {
  Trajectory trajectory;
  for (std::size_t i = 0; i < count; ++i) {
    const double time = static_cast<double>(i) / 10.0;
    const Eigen::Quaterniond rotation = Eigen::AngleAxisd(0.4 * time, Eigen::Vector3d::UnitY()) *
                                        Eigen::AngleAxisd(0.2 * time, Eigen::Vector3d::UnitX());
    trajectory.push_back(
        stampedPose(time, {std::cos(0.5 * time), std::sin(0.5 * time), 0.1 * time}, rotation));
  }
  return trajectory;
}

inline double uniform(std::mt19937& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

inline Eigen::Isometry3d randomPose(std::mt19937& random, double reach) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  const auto draw = [&] { return uniform(random, -1.0, 1.0); };
  const Eigen::Vector3d axis(draw(), draw(), draw());
  pose.linear() = Eigen::AngleAxisd(3.0 * draw(), axis.normalized()).toRotationMatrix();
  pose.translation() = reach * Eigen::Vector3d(draw(), draw(), draw());
  return pose;
}

/// Each pose moved and turned a little, as an estimate with errors.
inline Trajectory disturbed(Trajectory trajectory, std::mt19937& random) {
  for (StampedPose& stamped : trajectory) {
    const Eigen::Vector3d turn(uniform(random, -0.02, 0.02), uniform(random, -0.02, 0.02),
                               uniform(random, -0.02, 0.02));
    stamped.pose.rotate(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
    stamped.pose.translation() += turn;
  }
  return trajectory;
}

/// The same motion seen from another world frame.
inline Trajectory moved(const Eigen::Isometry3d& transform, Trajectory trajectory) {
  for (StampedPose& stamped : trajectory) {
    stamped.pose = transform * stamped.pose;
  }
  return trajectory;
}

/// The positions multiplied by a factor.
inline Trajectory resized(double factor, Trajectory trajectory) {
  for (StampedPose& stamped : trajectory) {
    stamped.pose.translation() *= factor;
  }
  return trajectory;
}

inline Trajectory delayed(double seconds, Trajectory trajectory) {
  for (StampedPose& stamped : trajectory) {
    stamped.timestamp += seconds;
  }
  return trajectory;
}

}  // namespace hmcdyn::evaluate::test

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include <Eigen/Geometry>

#include "synthesize/scene.hpp"

namespace hmcdyn::synthesize {

/// A camera at `position` that looks at `target` with the horizon level (m, world).
Eigen::Isometry3d lookAt(const Eigen::Vector3d& position, const Eigen::Vector3d& target);

/// Never moves.
CameraPath stillPath(const Eigen::Isometry3d& pose);

/// Out and back along x, then y, then z of the world, each in `slot` seconds.
CameraPath axesPath(const Eigen::Isometry3d& pose, double amplitude, double slot);

/// Roll, then pitch, then yaw, each in `slot` seconds (amplitude in rad).
CameraPath rotationsPath(const Eigen::Isometry3d& pose, double amplitude, double slot);

/// Yaw and pitch around the optical centre at once, and nothing else (amplitudes in rad).
CameraPath panningPath(const Eigen::Isometry3d& pose, double yaw, double pitch, double period);

/// Over a part of a half sphere around `centre`, always looking at it.
struct HalfSphere {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< (m)
  double radius = 2.2;                               ///< (m)
  double azimuth = 0.7;                              ///< Amplitude to both sides of -y (rad).
  double azimuth_period = 24.0;                      ///< (s)
  double low = 0.2;                                  ///< Elevations between which it swings (rad).
  double high = 0.5;                                 ///< (rad)
  double elevation_period = 13.0;                    ///< (s)
};
CameraPath halfSpherePath(const HalfSphere& sphere);

/// To and fro along a straight way, with the view held.
CameraPath shuttlePath(const Eigen::Isometry3d& pose, const Eigen::Vector3d& way, double period);

/// Along the sides of a triangle in the plane with rounded corners, looking at `target`.
CameraPath trianglePath(const Eigen::Vector3d& corner, double side, double period,
                        const Eigen::Vector3d& target);

/// Round and round on a level circle, counter-clockwise from above, looking away from its centre
/// and `down` below the horizon (rad), with a little up and down on the way (m).
struct Round {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< (m)
  double radius = 0.7;                               ///< (m)
  double period = 14.0;                              ///< Of a round (s).
  double down = 0.1;                                 ///< (rad)
  double bob = 0.05;  ///< Amplitude of height, 3.4 swings a round (m).
};
CameraPath roundPath(const Round& round);

/// Through a crowd: unrelated slow swings in all directions, the view wandering over `target`.
CameraPath strollPath(const Eigen::Vector3d& position, const Eigen::Vector3d& reach,
                      const Eigen::Vector3d& target, double period);

/// Adds the unsteadiness of a hand: smooth, a few tenths of a hertz to two hertz.
/// @param translation standard deviation (m); @param rotation standard deviation (rad).
CameraPath handHeld(CameraPath path, double translation, double rotation, std::uint64_t seed);

}  // namespace hmcdyn::synthesize

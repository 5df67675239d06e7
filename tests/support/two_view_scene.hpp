// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <hmcdyn/steps/epipolar.hpp>
#include <hmcdyn/types.hpp>

#include "random.hpp"

namespace hmcdyn::test {

inline constexpr PinholeCamera kSceneCamera{500.0, 510.0, 320.0, 240.0};
inline constexpr double kSceneWidth = 640.0;
inline constexpr double kSceneHeight = 480.0;

/// Rotation by an axis times an angle (degrees), and a translation (m).
inline Eigen::Isometry3d motionOf(const Eigen::Vector3d& degrees, const Eigen::Vector3d& metres) {
  constexpr double kRadians = 0.017453292519943295;
  const double angle = degrees.norm() * kRadians;
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  if (angle > 0.0) {
    motion.linear() = Eigen::AngleAxisd(angle, degrees.normalized()).toRotationMatrix();
  }
  motion.translation() = metres;
  return motion;
}

inline Eigen::Matrix3d calibrationMatrix(const PinholeCamera& camera) {
  Eigen::Matrix3d k = Eigen::Matrix3d::Identity();
  k(0, 0) = camera.fx;
  k(1, 1) = camera.fy;
  k(0, 2) = camera.cx;
  k(1, 2) = camera.cy;
  return k;
}

/// K^-T [t]x R K^-1 of a motion that takes points of the earlier camera's frame to the current one.
inline Eigen::Matrix3d fundamentalOf(const PinholeCamera& camera, const Eigen::Isometry3d& motion) {
  const Eigen::Vector3d t = motion.translation();
  Eigen::Matrix3d cross;
  cross << 0.0, -t.z(), t.y(), t.z(), 0.0, -t.x(), -t.y(), t.x(), 0.0;
  const Eigen::Matrix3d k_inverse = calibrationMatrix(camera).inverse();
  return k_inverse.transpose() * cross * motion.linear() * k_inverse;
}

/// Direction of an epipolar line in the current frame, by geometry alone: where two points of the
/// earlier pixel's ray are seen.
inline Eigen::Vector2d epipolarDirection(const PinholeCamera& camera,
                                         const Eigen::Isometry3d& motion,
                                         const Eigen::Vector2d& earlier) {
  const Eigen::Vector2d near =
      camera.project(motion * camera.unproject(earlier.x(), earlier.y(), 2.0));
  const Eigen::Vector2d far =
      camera.project(motion * camera.unproject(earlier.x(), earlier.y(), 4.0));
  return (far - near).normalized();
}

/// Static points seen from two poses.
struct TwoViewScene {
  std::vector<float> earlier_u, earlier_v, earlier_depth;
  std::vector<float> current_u, current_v, current_depth;

  std::size_t size() const { return current_u.size(); }
  PointPairsView pairs() const { return {earlier_u, earlier_v, current_u, current_v}; }
  Eigen::Vector2d earlier(std::size_t i) const { return {earlier_u[i], earlier_v[i]}; }
  Eigen::Vector2d current(std::size_t i) const { return {current_u[i], current_v[i]}; }
  void moveCurrent(std::size_t i, const Eigen::Vector2d& by) {
    current_u[i] = static_cast<float>(current_u[i] + by.x());
    current_v[i] = static_cast<float>(current_v[i] + by.y());
  }
};

struct SceneSettings {
  std::size_t points = 200;
  double min_depth = 1.0;  ///< (m)
  double max_depth = 6.0;  ///< (m)
  double noise = 0.0;      ///< Of every pixel coordinate in both frames (px).
  bool planar = false;     ///< All points on one slanted plane instead.
  std::uint32_t seed = 1;
};

/// Points spread over the earlier image that both frames see.
inline TwoViewScene makeScene(const Eigen::Isometry3d& current_from_earlier,
                              const SceneSettings& settings) {
  Random random(settings.seed);
  TwoViewScene scene;
  while (scene.size() < settings.points) {
    const double u = random.uniform(5.0, kSceneWidth - 5.0);
    const double v = random.uniform(5.0, kSceneHeight - 5.0);
    const double drawn = random.uniform(settings.min_depth, settings.max_depth);
    // The plane 0.2 x + 0.3 y + z = 3 m.
    const Eigen::Vector3d ray = kSceneCamera.unproject(u, v, 1.0);
    const double depth = settings.planar ? 3.0 / (0.2 * ray.x() + 0.3 * ray.y() + 1.0) : drawn;
    const Eigen::Vector3d moved = current_from_earlier * kSceneCamera.unproject(u, v, depth);
    const Eigen::Vector2d pixel = kSceneCamera.project(moved);
    const bool seen = moved.z() > 0.1 && pixel.x() >= 0.0 && pixel.x() < kSceneWidth &&
                      pixel.y() >= 0.0 && pixel.y() < kSceneHeight;
    if (!seen) {
      continue;
    }
    scene.earlier_u.push_back(static_cast<float>(u + random.normal(settings.noise)));
    scene.earlier_v.push_back(static_cast<float>(v + random.normal(settings.noise)));
    scene.earlier_depth.push_back(static_cast<float>(depth));
    scene.current_u.push_back(static_cast<float>(pixel.x() + random.normal(settings.noise)));
    scene.current_v.push_back(static_cast<float>(pixel.y() + random.normal(settings.noise)));
    scene.current_depth.push_back(static_cast<float>(moved.z()));
  }
  return scene;
}

}  // namespace hmcdyn::test

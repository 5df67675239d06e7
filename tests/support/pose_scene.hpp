// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <hmcdyn/pose_refinement.hpp>
#include <hmcdyn/types.hpp>

namespace hmcdyn::test {

/// Map points, what a camera at a known pose sees of them, and that pose.
struct PoseScene {
  PinholeCamera camera{535.4, 539.2, 320.1, 247.6};
  Eigen::Isometry3d camera_from_world = Eigen::Isometry3d::Identity();
  std::vector<float> x, y, z, u, v, sigma, depth, weight;

  std::size_t size() const { return x.size(); }
  PoseObservations view() const { return {x, y, z, u, v, sigma, depth, weight}; }
};

/// A vector of independent normal numbers.
inline Eigen::Vector3d gaussian3(std::mt19937& random, double deviation) {
  std::normal_distribution<double> normal(0.0, deviation);
  const double a = normal(random);
  const double b = normal(random);
  const double c = normal(random);
  return {a, b, c};
}

/// (Exp(rotation) R, Exp(rotation) t + translation): a motion in the camera's frame.
inline Eigen::Isometry3d moved(const Eigen::Isometry3d& pose, const Eigen::Vector3d& rotation,
                               const Eigen::Vector3d& translation) {
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  const double angle = rotation.norm();
  if (angle > 0.0) {
    motion.linear() = Eigen::AngleAxisd(angle, rotation / angle).toRotationMatrix();
  }
  motion.translation() = translation;
  return motion * pose;
}

/// The (rotation vector, translation) that moved() takes from one pose to another.
inline Eigen::Matrix<double, 6, 1> motionBetween(const Eigen::Isometry3d& from,
                                                 const Eigen::Isometry3d& to) {
  const Eigen::Isometry3d motion = to * from.inverse();
  const Eigen::AngleAxisd angle_axis(motion.linear());
  Eigen::Matrix<double, 6, 1> delta;
  delta << angle_axis.angle() * angle_axis.axis(), motion.translation();
  return delta;
}

/// Observes the scene's points anew from its pose, with noise of sigma_i times `noise` and depths
/// of deviation floor + quadratic * z^2 times `noise`.
inline void observe(PoseScene& scene, std::mt19937& random, double noise,
                    double depth_floor = 0.001, double depth_quadratic = 1.425e-3) {
  for (std::size_t i = 0; i < scene.size(); ++i) {
    const Eigen::Vector3d world(scene.x[i], scene.y[i], scene.z[i]);
    const Eigen::Vector3d p = scene.camera_from_world * world;
    const Eigen::Vector2d pixel = scene.camera.project(p);
    const Eigen::Vector3d error = gaussian3(random, noise);
    scene.u[i] = static_cast<float>(pixel.x() + scene.sigma[i] * error.x());
    scene.v[i] = static_cast<float>(pixel.y() + scene.sigma[i] * error.y());
    scene.depth[i] =
        static_cast<float>(p.z() + (depth_floor + depth_quadratic * p.z() * p.z()) * error.z());
  }
}

/// `points` points all over a 640x480 image, 1 to 5 m deep, seen from a random pose; sigma and
/// weight are 1. World coordinates are rounded to float first, so that without noise the pixels
/// are exact but for their own rounding.
inline PoseScene makePoseScene(std::uint32_t seed, std::size_t points, double noise = 0.0) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> column(5.0, 635.0);
  std::uniform_real_distribution<double> row(5.0, 475.0);
  std::uniform_real_distribution<double> depth(1.0, 5.0);
  PoseScene scene;
  const Eigen::Vector3d rotation = gaussian3(random, 0.5);
  scene.camera_from_world = moved(Eigen::Isometry3d::Identity(), rotation, gaussian3(random, 1.0));
  for (std::size_t i = 0; i < points; ++i) {
    const double u = column(random);
    const double v = row(random);
    const Eigen::Vector3f world =
        (scene.camera_from_world.inverse() * scene.camera.unproject(u, v, depth(random)))
            .cast<float>();
    scene.x.push_back(world.x());
    scene.y.push_back(world.y());
    scene.z.push_back(world.z());
  }
  scene.u.resize(points);
  scene.v.resize(points);
  scene.depth.resize(points);
  scene.sigma.assign(points, 1.0f);
  scene.weight.assign(points, 1.0f);
  observe(scene, random, noise);
  return scene;
}

/// The true pose, turned and moved aside: where refinement starts.
inline Eigen::Isometry3d disturbed(const PoseScene& scene, double radians = 0.03,
                                   double metres = 0.06) {
  return moved(scene.camera_from_world, radians * Eigen::Vector3d(0.6, -0.64, 0.48),
               metres * Eigen::Vector3d(-0.48, 0.6, 0.64));
}

}  // namespace hmcdyn::test

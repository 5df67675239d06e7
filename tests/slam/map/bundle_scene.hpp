// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "random.hpp"
#include "slam/map/bundle_adjustment.hpp"

namespace hmcdyn::slam::test {

using hmcdyn::test::Random;

inline Eigen::Vector3d gaussian(Random& random, double sigma) {
  const double x = random.normal(sigma);
  const double y = random.normal(sigma);
  return {x, y, random.normal(sigma)};
}

/// (Exp(rotation) R, Exp(rotation) t + translation), by Eigen's AngleAxis.
inline Eigen::Isometry3d moved(const Eigen::Isometry3d& pose, const Eigen::Vector3d& rotation,
                               const Eigen::Vector3d& translation) {
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  if (rotation.norm() > 0.0) {
    motion.linear() = Eigen::AngleAxisd(rotation.norm(), rotation.normalized()).toRotationMatrix();
  }
  motion.translation() = translation;
  return motion * pose;
}

/// Rotation (rad) and translation (m) between two poses, as one norm.
inline double poseDistance(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  const Eigen::Isometry3d motion = a * b.inverse();
  return Eigen::AngleAxisd(motion.linear()).angle() + motion.translation().norm();
}

/// A camera that walks sideways past a wall of points with relief, 640x480.
struct BundleScene {
  BundleProblem truth;  ///< Without noise; pose 0 is fixed.
};

/// @param seen_by key frames that see each point, those nearest to it.
/// @param noise times sigma = 1 px, and times the sensor's depth noise.
inline BundleScene makeBundleScene(std::uint32_t seed, int poses, int points, int seen_by,
                                   double noise) {
  Random random(seed);
  BundleScene scene;
  BundleProblem& problem = scene.truth;
  problem.camera = {535.4, 539.2, 320.1, 247.6};
  constexpr double kStep = 0.08;  // m
  for (int i = 0; i < poses; ++i) {
    BundlePose pose;
    const Eigen::Vector3d turn = gaussian(random, 0.05);
    pose.camera_from_world = moved(Eigen::Isometry3d(Eigen::Translation3d(-kStep * i, 0.0, 0.0)),
                                   turn, gaussian(random, 0.02));
    pose.fixed = i == 0;
    problem.poses.push_back(pose);
  }
  for (int j = 0; j < points; ++j) {
    const int first = random.integer(0, poses - seen_by);
    const double x = kStep * (first + 0.5 * (seen_by - 1)) + random.uniform(-0.7, 0.7);
    const double y = random.uniform(-0.6, 0.6);
    problem.points.emplace_back(x, y, random.uniform(1.5, 4.0));
    for (int i = first; i < first + seen_by; ++i) {
      const Eigen::Vector3d p =
          problem.poses[static_cast<std::size_t>(i)].camera_from_world * problem.points.back();
      const Eigen::Vector2d pixel = problem.camera.project(p);
      const Eigen::Vector3d error = gaussian(random, noise);
      BundleObservation observation;
      observation.pose = i;
      observation.point = j;
      observation.u = static_cast<float>(pixel.x() + error.x());
      observation.v = static_cast<float>(pixel.y() + error.y());
      observation.depth =
          static_cast<float>(p.z() + (0.001 + 1.425e-3 * p.z() * p.z()) * error.z());
      problem.observations.push_back(observation);
    }
  }
  return scene;
}

/// The problem with free poses and points moved at random.
inline BundleProblem disturbed(const BundleProblem& truth, std::uint32_t seed, double radians,
                               double metres) {
  Random random(seed);
  BundleProblem problem = truth;
  for (BundlePose& pose : problem.poses) {
    const Eigen::Vector3d turn = gaussian(random, radians);
    const Eigen::Vector3d shift = gaussian(random, metres);
    if (!pose.fixed) {
      pose.camera_from_world = moved(pose.camera_from_world, turn, shift);
    }
  }
  for (Eigen::Vector3d& point : problem.points) {
    point += gaussian(random, metres);
  }
  return problem;
}

inline double largestPoseError(const std::vector<Eigen::Isometry3d>& poses,
                               const BundleProblem& truth) {
  double largest = 0.0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    largest = std::max(largest, poseDistance(poses[i], truth.poses[i].camera_from_world));
  }
  return largest;
}

/// Goes on until nothing changes any more.
inline BundleOptions thorough() {
  BundleOptions options;
  options.max_iterations = 100;
  options.function_tolerance = 1e-14;
  return options;
}

}  // namespace hmcdyn::slam::test

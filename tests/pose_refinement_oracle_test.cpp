// SPDX-License-Identifier: BSD-3-Clause
// Against independent implementations: Gauss-Newton with numeric derivatives, OpenCV's refinement.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>

#include <hmcdyn/pose_refinement.hpp>

#include "pose_scene.hpp"

namespace hmcdyn {
namespace {

using test::gaussian3;
using test::makePoseScene;
using test::motionBetween;
using test::moved;
using test::PoseScene;
using Vector6d = Eigen::Matrix<double, 6, 1>;

struct OracleCase {
  const char* name;
  DepthRow row;
  bool huber;
};

/// The residual of eq. 9 without lambda, written out once more from the paper.
Eigen::Vector3d residualOf(const PoseScene& scene, const Eigen::Isometry3d& pose, std::size_t i,
                           const PoseRefinementOptions& options) {
  const Eigen::Vector3d p = pose * Eigen::Vector3d(scene.x[i], scene.y[i], scene.z[i]);
  const double u = scene.camera.fx * (p.x() / p.z()) + scene.camera.cx;
  const double v = scene.camera.fy * (p.y() / p.z()) + scene.camera.cy;
  Eigen::Vector3d e((scene.u[i] - u) / scene.sigma[i], (scene.v[i] - v) / scene.sigma[i], 0.0);
  const double z = scene.depth[i];
  if (options.depth_row == DepthRow::kDepth) {
    const DepthErrorModel& model = options.depth_error;
    const double noise = model.noise_floor + model.noise_quadratic * z * z;
    const double systematic = model.systematic_linear * z + model.systematic_quadratic * z * z;
    e.z() = (z - p.z()) / std::sqrt(noise * noise + systematic * systematic);
  } else if (options.depth_row == DepthRow::kDisparity) {
    const double right = scene.u[i] - options.baseline_fx / z;
    e.z() = (right - (u - options.baseline_fx / p.z())) / scene.sigma[i];
  }
  return e;
}

/// Iteratively reweighted Gauss-Newton on sum lambda^2 rho(|e|^2), numeric derivatives.
Eigen::Isometry3d gaussNewton(const PoseScene& scene, Eigen::Isometry3d pose,
                              const PoseRefinementOptions& options, bool huber) {
  const double limit = options.depth_row == DepthRow::kNone ? std::sqrt(5.991) : std::sqrt(7.815);
  for (int iteration = 0; iteration < 60; ++iteration) {
    Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
    Vector6d right = Vector6d::Zero();
    for (std::size_t i = 0; i < scene.size(); ++i) {
      constexpr double kStep = 1e-6;
      const Eigen::Vector3d e = residualOf(scene, pose, i, options);
      Eigen::Matrix<double, 3, 6> jacobian;
      for (int k = 0; k < 6; ++k) {
        const Vector6d step = kStep * Vector6d::Unit(k);
        jacobian.col(k) =
            (residualOf(scene, moved(pose, step.head<3>(), step.tail<3>()), i, options) -
             residualOf(scene, moved(pose, -step.head<3>(), -step.tail<3>()), i, options)) /
            (2.0 * kStep);
      }
      const double factor = scene.weight[i] * scene.weight[i] *
                            (huber ? std::min(1.0, limit / std::max(e.norm(), 1e-12)) : 1.0);
      normal += factor * jacobian.transpose() * jacobian;
      right -= factor * jacobian.transpose() * e;
    }
    const Vector6d step = normal.ldlt().solve(right);
    pose = moved(pose, step.head<3>(), step.tail<3>());
  }
  return pose;
}

class AgainstGaussNewton : public ::testing::TestWithParam<OracleCase> {};

TEST_P(AgainstGaussNewton, FindsTheSameMinimum) {
  for (const unsigned seed : {51U, 52U, 53U}) {
    // Given weights and sigmas all over their range, and one point in ten 15 px off,
    PoseScene scene = makePoseScene(seed, 120, 1.0);
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> uniform(0.05f, 1.0f);
    for (std::size_t i = 0; i < scene.size(); ++i) {
      scene.weight[i] = uniform(random);
      scene.sigma[i] = 0.5f + uniform(random);
      scene.u[i] += i % 10 == 0 ? 15.0f : 0.0f;
    }
    PoseRefinementOptions options;
    options.depth_row = GetParam().row;
    options.loss = GetParam().huber ? RobustLoss::kHuber : RobustLoss::kNone;
    options.rounds = 1;
    options.plain_rounds = 0;
    options.max_iterations = 200;
    options.function_tolerance = 1e-15;
    const Eigen::Isometry3d initial =
        moved(scene.camera_from_world, gaussian3(random, 0.02), gaussian3(random, 0.03));

    const auto result = refinePose(scene.view(), scene.camera, initial, options);
    const Eigen::Isometry3d expected =
        gaussNewton(scene, scene.camera_from_world, options, GetParam().huber);

    ASSERT_TRUE(result.succeeded()) << result.message;
    EXPECT_LT(motionBetween(result.camera_from_world, expected).norm(), 1e-7);
  }
}

INSTANTIATE_TEST_SUITE_P(Costs, AgainstGaussNewton,
                         ::testing::Values(OracleCase{"pixels", DepthRow::kNone, false},
                                           OracleCase{"pixels_huber", DepthRow::kNone, true},
                                           OracleCase{"depth", DepthRow::kDepth, false},
                                           OracleCase{"depth_huber", DepthRow::kDepth, true},
                                           OracleCase{"disparity", DepthRow::kDisparity, false},
                                           OracleCase{"disparity_huber", DepthRow::kDisparity,
                                                      true}),
                         [](const auto& one) { return one.param.name; });

TEST(AgainstOpenCv, UnweightedLeastSquaresIsSolvePnPRefineLm) {
  for (const unsigned seed : {61U, 62U, 63U}) {
    const PoseScene scene = makePoseScene(seed, 100, 1.0);
    std::mt19937 random(seed);
    const Eigen::Isometry3d initial =
        moved(scene.camera_from_world, gaussian3(random, 0.01), gaussian3(random, 0.02));

    std::vector<cv::Point3d> world;
    std::vector<cv::Point2d> pixels;
    for (std::size_t i = 0; i < scene.size(); ++i) {
      world.emplace_back(scene.x[i], scene.y[i], scene.z[i]);
      pixels.emplace_back(scene.u[i], scene.v[i]);
    }
    const cv::Matx33d matrix(scene.camera.fx, 0.0, scene.camera.cx, 0.0, scene.camera.fy,
                             scene.camera.cy, 0.0, 0.0, 1.0);
    const Eigen::AngleAxisd angle_axis(initial.linear());
    const Eigen::Vector3d start = angle_axis.angle() * angle_axis.axis();
    cv::Vec3d rotation(start.x(), start.y(), start.z());
    cv::Vec3d translation(initial.translation().x(), initial.translation().y(),
                          initial.translation().z());
    cv::solvePnPRefineLM(
        world, pixels, matrix, cv::noArray(), rotation, translation,
        cv::TermCriteria(cv::TermCriteria::EPS + cv::TermCriteria::COUNT, 100, 1e-12));
    const Eigen::Isometry3d expected =
        moved(Eigen::Isometry3d::Identity(), {rotation[0], rotation[1], rotation[2]},
              {translation[0], translation[1], translation[2]});

    PoseRefinementOptions options;
    options.loss = RobustLoss::kNone;
    options.rounds = 1;
    options.plain_rounds = 0;
    options.function_tolerance = 1e-15;
    const auto result = refinePose(scene.view(), scene.camera, initial, options);
    EXPECT_LT(motionBetween(result.camera_from_world, expected).norm(), 1e-7);
  }
}

}  // namespace
}  // namespace hmcdyn

// SPDX-License-Identifier: BSD-3-Clause
// The joint mode: against Ceres with the weights as parameters, and against moving suspects.
#include <array>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <ceres/ceres.h>
#include <ceres/rotation.h>
#include <gtest/gtest.h>

#include <hmcdyn/pose_refinement.hpp>

#include "pose_scene.hpp"

namespace hmcdyn {
namespace {

using test::gaussian3;
using test::makePoseScene;
using test::motionBetween;
using test::moved;
using test::PoseScene;

/// The first `moving` of the scene's last `suspects` points slide by a common motion (px); the
/// suspects' weights are drawn from 0.2..0.9 and know nothing of who moves.
PoseScene sceneWithSuspects(unsigned seed, std::size_t fixed, std::size_t suspects,
                            std::size_t moving, double motion) {
  PoseScene scene = makePoseScene(seed, fixed + suspects, 1.0);
  std::mt19937 random(seed + 7919);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const double direction = 2.0 * M_PI * uniform(random);
  for (std::size_t i = fixed; i < scene.size(); ++i) {
    scene.weight[i] = static_cast<float>(0.2 + 0.7 * uniform(random));
    if (i < fixed + moving) {
      scene.u[i] += static_cast<float>(motion * std::cos(direction));
      scene.v[i] += static_cast<float>(motion * std::sin(direction));
    }
  }
  return scene;
}

/// Eq. 9 with lambda as a parameter: pose as (angle axis, translation).
struct JointResidual {
  Eigen::Vector3d world;
  Eigen::Vector2d pixel;
  PinholeCamera camera;

  template <class T>
  bool operator()(const T* pose, const T* lambda, T* residual) const {
    const std::array<T, 3> point{T(world.x()), T(world.y()), T(world.z())};
    std::array<T, 3> p{};
    ceres::AngleAxisRotatePoint(pose, point.data(), p.data());
    const T x = p[0] + pose[3];
    const T y = p[1] + pose[4];
    const T z = p[2] + pose[5];
    residual[0] = lambda[0] * (pixel.x() - camera.fx * x / z - camera.cx);
    residual[1] = lambda[0] * (pixel.y() - camera.fy * y / z - camera.cy);
    return true;
  }
};

struct PriorResidual {
  double root_kappa;
  double lambda0;

  template <class T>
  bool operator()(const T* lambda, T* residual) const {
    residual[0] = root_kappa * (lambda[0] - lambda0);
    return true;
  }
};

struct JointSolution {
  Eigen::Isometry3d pose;
  std::vector<double> lambda;
  double cost = 0.0;
};

/// The joint problem as Suenderhauf and Protzel state it: a bounded parameter a weight.
JointSolution solveJointly(const PoseScene& scene, const Eigen::Isometry3d& initial, double kappa) {
  const Eigen::AngleAxisd angle_axis(initial.linear());
  Eigen::Matrix<double, 6, 1> pose;
  pose << angle_axis.angle() * angle_axis.axis(), initial.translation();
  JointSolution solution;
  solution.lambda.assign(scene.weight.begin(), scene.weight.end());
  ceres::Problem problem;
  for (std::size_t i = 0; i < scene.size(); ++i) {
    double* lambda = &solution.lambda[i];
    const Eigen::Vector3d world(scene.x[i], scene.y[i], scene.z[i]);
    const Eigen::Vector2d pixel(scene.u[i], scene.v[i]);
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<JointResidual, 2, 6, 1>(
                                 new JointResidual{world, pixel, scene.camera}),
                             nullptr, pose.data(), lambda);
    if (*lambda < 1.0) {
      problem.AddResidualBlock(new ceres::AutoDiffCostFunction<PriorResidual, 1, 1>(
                                   new PriorResidual{std::sqrt(kappa), *lambda}),
                               nullptr, lambda);
      problem.SetParameterLowerBound(lambda, 0, 0.0);
      problem.SetParameterUpperBound(lambda, 0, 1.0);
    } else {
      problem.SetParameterBlockConstant(lambda);
    }
  }
  ceres::Solver::Options options;
  options.logging_type = ceres::SILENT;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = 500;
  options.function_tolerance = 1e-15;
  options.gradient_tolerance = 1e-12;
  options.parameter_tolerance = 1e-14;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  solution.pose = moved(Eigen::Isometry3d::Identity(), pose.head<3>(), pose.tail<3>());
  solution.cost = 2.0 * summary.final_cost;
  return solution;
}

TEST(JointMode, IsTheMinimumOverPoseAndWeights) {
  for (const unsigned seed : {71U, 72U, 73U}) {
    const PoseScene scene = sceneWithSuspects(seed, 40, 30, 12, 6.0);
    std::mt19937 random(seed);
    const Eigen::Isometry3d initial =
        moved(scene.camera_from_world, gaussian3(random, 0.002), gaussian3(random, 0.004));
    PoseRefinementOptions options;
    options.weight_mode = WeightMode::kJoint;
    options.kappa = 4.0;
    options.loss = RobustLoss::kNone;
    options.rounds = 1;
    options.plain_rounds = 0;
    options.max_iterations = 200;
    options.function_tolerance = 1e-15;

    const auto result = refinePose(scene.view(), scene.camera, initial, options);
    const JointSolution expected = solveJointly(scene, initial, 4.0);

    ASSERT_TRUE(result.succeeded()) << result.message;
    EXPECT_LT(motionBetween(result.camera_from_world, expected.pose).norm(), 1e-6);
    EXPECT_NEAR(result.final_cost, expected.cost, 1e-6 * expected.cost);
    for (std::size_t i = 0; i < scene.size(); ++i) {
      EXPECT_NEAR(result.weight[i], expected.lambda[i], 1e-4) << i;
    }
  }
}

TEST(JointMode, LeavesCertainWeightsAlone) {
  PoseScene scene = makePoseScene(74, 60, 1.0);
  scene.weight[5] = 0.0f;
  PoseRefinementOptions options;
  const auto fixed = refinePose(scene.view(), scene.camera, scene.camera_from_world, options);
  options.weight_mode = WeightMode::kJoint;
  const auto joint = refinePose(scene.view(), scene.camera, scene.camera_from_world, options);
  EXPECT_EQ(joint.camera_from_world, fixed.camera_from_world);
  EXPECT_EQ(joint.weight, scene.weight);
}

TEST(JointMode, FixedModeReturnsTheWeightsGiven) {
  const PoseScene scene = sceneWithSuspects(75, 40, 30, 12, 6.0);
  EXPECT_EQ(refinePose(scene.view(), scene.camera, scene.camera_from_world).weight, scene.weight);
}

TEST(JointMode, SuspectBehindTheCameraHasNoWeight) {
  PoseScene scene = makePoseScene(76, 60, 1.0);
  const Eigen::Vector3d behind = scene.camera_from_world.inverse() * Eigen::Vector3d(0, 0, -2);
  scene.x[9] = static_cast<float>(behind.x());
  scene.y[9] = static_cast<float>(behind.y());
  scene.z[9] = static_cast<float>(behind.z());
  scene.weight[9] = 0.5f;
  PoseRefinementOptions options;
  options.weight_mode = WeightMode::kJoint;
  const auto result = refinePose(scene.view(), scene.camera, scene.camera_from_world, options);
  EXPECT_EQ(result.weight[9], 0.0f);
}

struct MovingCase {
  unsigned seed;
  double moving_share;
  double motion;  // px
};

class MovingSuspects : public ::testing::TestWithParam<MovingCase> {};

TEST_P(MovingSuspects, LoseTheirWeightAndTheOthersKeepTheirs) {
  constexpr std::size_t kFixed = 80;
  constexpr std::size_t kSuspects = 120;
  const auto moving = static_cast<std::size_t>(GetParam().moving_share * kSuspects);
  const PoseScene scene =
      sceneWithSuspects(GetParam().seed, kFixed, kSuspects, moving, GetParam().motion);
  std::mt19937 random(GetParam().seed);
  const Eigen::Isometry3d initial =
      moved(scene.camera_from_world, gaussian3(random, 0.01), gaussian3(random, 0.02));
  PoseRefinementOptions options;
  options.weight_mode = WeightMode::kJoint;
  options.kappa = 6.0;

  const auto result = refinePose(scene.view(), scene.camera, initial, options);
  ASSERT_TRUE(result.succeeded()) << result.message;

  double kept_moving = 0.0;
  double kept_static = 0.0;
  for (std::size_t i = kFixed; i < scene.size(); ++i) {
    (i < kFixed + moving ? kept_moving : kept_static) += result.weight[i] / scene.weight[i];
  }
  kept_moving /= static_cast<double>(moving);
  kept_static /= static_cast<double>(kSuspects - moving);
  // kappa / (kappa + s) with kappa = 6: for a point at rest s is chi2(2), whose mean share is
  // 3 e^3 E1(3) = 0.786; for a moving one s is about the motion squared.
  EXPECT_NEAR(kept_static, 0.786, 0.08);
  EXPECT_LT(kept_moving, 1.5 * 6.0 / (6.0 + GetParam().motion * GetParam().motion));
  // The pose is at most as far off as one would expect of the fixed points alone: some mm.
  EXPECT_LT(motionBetween(result.camera_from_world, scene.camera_from_world).norm(), 0.01);
}

INSTANTIATE_TEST_SUITE_P(Motions, MovingSuspects,
                         ::testing::Values(MovingCase{81, 0.3, 6.0}, MovingCase{82, 0.3, 12.0},
                                           MovingCase{83, 0.3, 30.0}, MovingCase{84, 0.6, 6.0},
                                           MovingCase{85, 0.6, 12.0}, MovingCase{86, 0.6, 30.0}));

/// Root mean square of the pose error of both modes over 40 frames of 20 points beyond suspicion
/// and 180 suspects.
struct ModeErrors {
  double fixed = 0.0;
  double joint = 0.0;
};

ModeErrors errorsOfBothModes(std::size_t moving, double motion) {
  constexpr unsigned kFrames = 40;
  ModeErrors errors;
  for (unsigned seed = 0; seed < kFrames; ++seed) {
    const PoseScene scene = sceneWithSuspects(2000 + seed, 20, 180, moving, motion);
    PoseRefinementOptions options;
    const auto errorOf = [&scene, &options] {
      return motionBetween(refinePose(scene.view(), scene.camera, scene.camera_from_world, options)
                               .camera_from_world,
                           scene.camera_from_world)
          .squaredNorm();
    };
    errors.fixed += errorOf() / kFrames;
    options.weight_mode = WeightMode::kJoint;
    errors.joint += errorOf() / kFrames;
  }
  return {std::sqrt(errors.fixed), std::sqrt(errors.joint)};
}

TEST(JointMode, BeatsFixedWeightsWhereMostSuspectsMove) {
  const ModeErrors errors = errorsOfBothModes(108, 10.0);
  EXPECT_LT(errors.joint, 0.5 * errors.fixed);
}

TEST(JointMode, CostsLittleWhereNoneMoves) {
  const ModeErrors errors = errorsOfBothModes(0, 0.0);
  EXPECT_LT(errors.joint, 1.25 * errors.fixed);
}

}  // namespace
}  // namespace hmcdyn

// SPDX-License-Identifier: BSD-3-Clause
// PoseSolver::kCollapsed against PoseSolver::kCeresProblem on random problems.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <string>

#include <Eigen/Core>
#include <Eigen/Geometry>
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

struct EquivalenceCase {
  const char* name;
  DepthRow row;
  RobustLoss loss;
  WeightMode mode;
};

struct Problem {
  PoseScene scene;
  Eigen::Isometry3d initial;
};

/// 1 px of noise; from 20 points on, one in ten an outlier, one in eight of weight zero, one in
/// fifteen behind the camera, every fourth with a weight between, one in twenty without a depth.
Problem randomProblem(std::uint32_t seed, std::size_t points) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
  Problem problem{makePoseScene(seed, points, points < 20 ? 0.3 : 1.0), {}};
  PoseScene& scene = problem.scene;
  problem.initial =
      moved(scene.camera_from_world, gaussian3(random, 0.01), gaussian3(random, 0.02));
  for (std::size_t i = 0; i < points; ++i) {
    scene.sigma[i] = 0.7f + 0.6f * uniform(random);
    if (i % 4 == 1) {
      scene.weight[i] = 0.1f + 0.9f * uniform(random);
    }
    if (points < 20) {
      continue;
    }
    if (i % 10 == 3) {
      scene.u[i] = 640.0f * uniform(random);
      scene.v[i] = 480.0f * uniform(random);
    }
    if (i % 15 == 4) {
      const Eigen::Vector3d behind =
          scene.camera_from_world.inverse() * scene.camera.unproject(300.0, 200.0, -2.0);
      scene.x[i] = static_cast<float>(behind.x());
      scene.y[i] = static_cast<float>(behind.y());
      scene.z[i] = static_cast<float>(behind.z());
    }
    scene.weight[i] = i % 8 == 6 ? 0.0f : scene.weight[i];
    scene.depth[i] = i % 20 == 9 ? 0.0f : scene.depth[i];
  }
  return problem;
}

PoseRefinementResult refineBy(PoseSolver solver, const Problem& problem,
                              PoseRefinementOptions options) {
  options.solver = solver;
  return refinePose(problem.scene.view(), problem.scene.camera, problem.initial, options);
}

class BothSolvers : public ::testing::TestWithParam<EquivalenceCase> {
 protected:
  static PoseRefinementOptions options() {
    PoseRefinementOptions options;
    options.depth_row = GetParam().row;
    options.loss = GetParam().loss;
    options.weight_mode = GetParam().mode;
    options.max_iterations = 100;
    return options;
  }
};

constexpr std::size_t kSizes[] = {3, 4, 5, 6, 10, 20, 50, 100, 333, 1000};

TEST_P(BothSolvers, ReachTheSameCostInOneRound) {
  for (const std::size_t points : kSizes) {
    for (std::uint32_t seed = 1; seed <= 6; ++seed) {
      const Problem problem =
          randomProblem(1000 * seed + static_cast<std::uint32_t>(points), points);
      PoseRefinementOptions one_round = options();
      one_round.rounds = 1;
      one_round.plain_rounds = 0;
      one_round.chi2_two_rows = 1e9;  // the test for inliers is not the question here
      one_round.chi2_three_rows = 1e9;
      const auto fast = refineBy(PoseSolver::kCollapsed, problem, one_round);
      one_round.function_tolerance = 1e-14;
      const auto oracle = refineBy(PoseSolver::kCeresProblem, problem, one_round);

      SCOPED_TRACE(std::to_string(points) + " points, seed " + std::to_string(seed));
      ASSERT_TRUE(oracle.succeeded()) << oracle.message;
      ASSERT_TRUE(fast.succeeded()) << fast.message;
      EXPECT_NEAR(fast.initial_cost, oracle.initial_cost, 1e-9 * oracle.initial_cost);
      // 1e-9: three points without depth can be met exactly.
      EXPECT_NEAR(fast.final_cost, oracle.final_cost, 1e-6 * oracle.final_cost + 1e-9);
      EXPECT_EQ(fast.usable_points, oracle.usable_points);
    }
  }
}

TEST_P(BothSolvers, AgreeAfterAllRounds) {
  int refined = 0;
  for (const std::size_t points : {10U, 50U, 333U, 1000U}) {
    for (std::uint32_t seed = 1; seed <= 4; ++seed) {
      const Problem problem =
          randomProblem(7000 * seed + static_cast<std::uint32_t>(points), points);
      PoseRefinementOptions exact = options();
      exact.function_tolerance = 1e-13;  // so that no point falls to either side of the test
      const auto fast = refineBy(PoseSolver::kCollapsed, problem, exact);
      const auto oracle = refineBy(PoseSolver::kCeresProblem, problem, exact);

      SCOPED_TRACE(std::to_string(points) + " points, seed " + std::to_string(seed));
      ASSERT_EQ(fast.termination, oracle.termination) << fast.message << ", " << oracle.message;
      if (!oracle.succeeded()) {
        continue;  // without a robust loss outliers leave too few inliers, now and then
      }
      ++refined;
      EXPECT_EQ(fast.inlier, oracle.inlier);
      EXPECT_EQ(fast.inliers, oracle.inliers);
      EXPECT_NEAR(fast.final_cost, oracle.final_cost, 1e-6 * oracle.final_cost + 1e-9);
      ASSERT_EQ(fast.covariance.has_value(), oracle.covariance.has_value());
      EXPECT_TRUE(fast.covariance->map().isApprox(oracle.covariance->map(), 1e-4));
      const auto delta = motionBetween(fast.camera_from_world, oracle.camera_from_world);
      EXPECT_LT(delta.dot(oracle.covariance->map().ldlt().solve(delta)), 1e-6);
      for (std::size_t i = 0; i < points; ++i) {
        EXPECT_NEAR(fast.weight[i], oracle.weight[i], 1e-4) << i;
      }
    }
  }
  EXPECT_GE(refined, 8) << "of 16";
}

TEST_P(BothSolvers, RefuseTheSameStepsBehindTheCamera) {
  // Given points 8 cm from the camera, and a start from which a full step would pass them,
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    Problem problem{makePoseScene(seed, 40, 0.5), {}};
    PoseScene& scene = problem.scene;
    for (std::size_t i = 0; i < 4; ++i) {
      const double u = 200.0 + 80.0 * static_cast<double>(i);
      const Eigen::Vector3d near =
          scene.camera_from_world.inverse() * scene.camera.unproject(u, 240.0, 0.08);
      scene.x[i] = static_cast<float>(near.x());
      scene.y[i] = static_cast<float>(near.y());
      scene.z[i] = static_cast<float>(near.z());
      scene.u[i] = static_cast<float>(u);
      scene.v[i] = 240.0f;
      scene.depth[i] = 0.08f;
    }
    problem.initial = moved(scene.camera_from_world, Eigen::Vector3d(0.01, -0.02, 0.01),
                            Eigen::Vector3d(0.01, 0.0, 0.08));
    PoseRefinementOptions one_round = options();
    one_round.rounds = 1;
    one_round.plain_rounds = 0;
    one_round.max_iterations = 200;
    one_round.function_tolerance = 1e-13;
    const auto fast = refineBy(PoseSolver::kCollapsed, problem, one_round);
    const auto oracle = refineBy(PoseSolver::kCeresProblem, problem, one_round);
    ASSERT_TRUE(fast.succeeded()) << fast.message;
    ASSERT_TRUE(oracle.succeeded()) << oracle.message;
    // then neither has a point behind the camera that it started with, and both costs are equal.
    for (std::size_t i = 0; i < scene.size(); ++i) {
      const Eigen::Vector3d world(scene.x[i], scene.y[i], scene.z[i]);
      EXPECT_GE((fast.camera_from_world * world).z(), one_round.min_depth) << i;
    }
    EXPECT_NEAR(fast.final_cost, oracle.final_cost, 1e-6 * oracle.final_cost);
  }
}

TEST_P(BothSolvers, AgreeWithoutALeastDepth) {
  // Given min_depth = 0, and points in and behind the plane of the camera,
  Problem problem = randomProblem(11, 100);
  PoseScene& scene = problem.scene;
  for (std::size_t i = 0; i < 6; ++i) {
    const double z = i % 2 == 0 ? 0.0 : -1e-3;
    const Eigen::Vector3d world =
        problem.initial.inverse() * Eigen::Vector3d(0.1 * static_cast<double>(i), 0.3, z);
    scene.x[i] = static_cast<float>(world.x());
    scene.y[i] = static_cast<float>(world.y());
    scene.z[i] = static_cast<float>(world.z());
  }
  // of which those in the plane, where rounding decides, have no weight,
  scene.weight[0] = scene.weight[2] = scene.weight[4] = 0.0f;
  PoseRefinementOptions one_round = options();
  one_round.rounds = 1;
  one_round.plain_rounds = 0;
  one_round.min_depth = 0.0;
  one_round.chi2_two_rows = 1e9;
  one_round.chi2_three_rows = 1e9;
  one_round.function_tolerance = 1e-13;
  const auto fast = refineBy(PoseSolver::kCollapsed, problem, one_round);
  const auto oracle = refineBy(PoseSolver::kCeresProblem, problem, one_round);
  ASSERT_TRUE(fast.succeeded()) << fast.message;
  ASSERT_TRUE(oracle.succeeded()) << oracle.message;
  EXPECT_EQ(fast.usable_points, oracle.usable_points);
  EXPECT_NEAR(fast.final_cost, oracle.final_cost, 1e-6 * oracle.final_cost);
}

INSTANTIATE_TEST_SUITE_P(
    Costs, BothSolvers,
    ::testing::Values(
        EquivalenceCase{"pixels", DepthRow::kNone, RobustLoss::kNone, WeightMode::kFixed},
        EquivalenceCase{"pixels_huber", DepthRow::kNone, RobustLoss::kHuber, WeightMode::kFixed},
        EquivalenceCase{"depth", DepthRow::kDepth, RobustLoss::kNone, WeightMode::kFixed},
        EquivalenceCase{"depth_huber", DepthRow::kDepth, RobustLoss::kHuber, WeightMode::kFixed},
        EquivalenceCase{"disparity_huber", DepthRow::kDisparity, RobustLoss::kHuber,
                        WeightMode::kFixed},
        EquivalenceCase{"pixels_joint", DepthRow::kNone, RobustLoss::kHuber, WeightMode::kJoint},
        EquivalenceCase{"depth_joint", DepthRow::kDepth, RobustLoss::kNone, WeightMode::kJoint},
        EquivalenceCase{"disparity_joint", DepthRow::kDisparity, RobustLoss::kHuber,
                        WeightMode::kJoint}),
    [](const auto& one) { return one.param.name; });

TEST(BothSolversFail, ForTheSameReasons) {
  const auto expectBoth = [](const Problem& problem, PoseRefinementTermination why) {
    for (const PoseSolver solver : {PoseSolver::kCollapsed, PoseSolver::kCeresProblem}) {
      const auto result = refineBy(solver, problem, {});
      EXPECT_EQ(result.termination, why) << result.message;
      EXPECT_EQ(result.camera_from_world, Pose(problem.initial));
    }
  };
  Problem problem = randomProblem(5, 100);
  std::fill(problem.scene.weight.begin() + 2, problem.scene.weight.end(), 0.0f);
  expectBoth(problem, PoseRefinementTermination::kTooFewPoints);

  problem = randomProblem(6, 100);
  std::reverse(problem.scene.u.begin(), problem.scene.u.end());
  problem.scene.sigma.assign(100, 1e-4f);
  expectBoth(problem, PoseRefinementTermination::kTooFewInliers);

  problem = randomProblem(7, 100);
  problem.scene.camera.fx = 1e200;
  expectBoth(problem, PoseRefinementTermination::kNumericalFailure);
}

}  // namespace
}  // namespace hmcdyn

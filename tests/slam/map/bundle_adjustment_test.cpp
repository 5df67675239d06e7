// SPDX-License-Identifier: BSD-3-Clause
// What a correct bundle adjustment must satisfy: recovery, optimality, outliers, repeatability.
#include "slam/map/bundle_adjustment.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <unsupported/Eigen/NonLinearOptimization>
#include <unsupported/Eigen/NumericalDiff>

#include "map/bundle_scene.hpp"

namespace hmcdyn::slam {
namespace {

using test::BundleScene;
using test::disturbed;
using test::largestPoseError;
using test::makeBundleScene;
using test::moved;

BundleOptions leastSquares() {
  BundleOptions options;
  options.depth_error.systematic_quadratic = 0.0f;  // as the scene
  options.rounds = 1;
  options.plain_rounds = 1;
  options.max_iterations = 50;
  options.function_tolerance = 1e-14;
  return options;
}

class BundleSolver : public ::testing::TestWithParam<int> {};  // max_dense_poses

// The pixels are rounded to float, 2^-15 px at most: 6e-8 rad, and 1e-7 m of 4 m in the depths.
TEST_P(BundleSolver, RecoversPosesAndPointsWithoutNoise) {
  const BundleScene scene = makeBundleScene(1, 8, 150, 5, 0.0);
  BundleOptions options = leastSquares();
  options.max_dense_poses = GetParam();
  const BundleSolution solution = adjustBundle(disturbed(scene.truth, 2, 0.02, 0.05), options);
  EXPECT_EQ(solution.termination, BundleTermination::kConverged) << solution.message;
  EXPECT_LT(largestPoseError(solution.poses, scene.truth), 2e-6);
  for (std::size_t j = 0; j < solution.points.size(); ++j) {
    EXPECT_LT((solution.points[j] - scene.truth.points[j]).norm(), 1e-5);
  }
  EXPECT_EQ(solution.inliers, scene.truth.observations.size());
  EXPECT_EQ(solution.used, scene.truth.observations.size());
  EXPECT_GT(solution.initial_cost, 1e3);
  EXPECT_LT(solution.final_cost, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(DenseAndSparse, BundleSolver, ::testing::Values(100, 0));

/// The same least squares for Eigen's Levenberg-Marquardt with numerical derivatives: the poses
/// beyond the first as rotation vectors and translations, then the points.
struct Oracle {
  using Scalar = double;
  using InputType = Eigen::VectorXd;
  using ValueType = Eigen::VectorXd;
  using JacobianType = Eigen::MatrixXd;
  enum { InputsAtCompileTime = Eigen::Dynamic, ValuesAtCompileTime = Eigen::Dynamic };

  const BundleProblem* problem;
  int inputs() const {
    return static_cast<int>(6 * (problem->poses.size() - 1) + 3 * problem->points.size());
  }
  int values() const { return static_cast<int>(3 * problem->observations.size()); }

  int operator()(const Eigen::VectorXd& x, Eigen::VectorXd& residuals) const {
    const auto points_at = static_cast<Eigen::Index>(6 * (problem->poses.size() - 1));
    for (std::size_t k = 0; k < problem->observations.size(); ++k) {
      const BundleObservation& o = problem->observations[k];
      Eigen::Isometry3d pose = problem->poses[0].camera_from_world;
      if (o.pose > 0) {
        const Eigen::Vector3d rotation = x.segment<3>(6 * (o.pose - 1));
        pose = moved(Eigen::Isometry3d::Identity(), rotation, x.segment<3>(6 * (o.pose - 1) + 3));
      }
      const Eigen::Vector3d p = pose * Eigen::Vector3d(x.segment<3>(points_at + 3 * o.point));
      const double z = o.depth;
      const auto row = static_cast<Eigen::Index>(3 * k);
      residuals(row) = o.u - (535.4 * p.x() / p.z() + 320.1);
      residuals(row + 1) = o.v - (539.2 * p.y() / p.z() + 247.6);
      residuals(row + 2) = (z - p.z()) / (double{0.001f} + double{1.425e-3f} * z * z);
    }
    return 0;
  }
};

TEST(BundleAdjustment, FindsTheMinimumThatAnotherSolverFinds) {
  const BundleScene scene = makeBundleScene(3, 4, 25, 4, 1.0);
  const BundleProblem problem = disturbed(scene.truth, 4, 0.005, 0.01);
  const BundleSolution solution = adjustBundle(problem, leastSquares());
  ASSERT_EQ(solution.termination, BundleTermination::kConverged) << solution.message;

  Oracle oracle{&problem};
  Eigen::VectorXd x(oracle.inputs());
  for (std::size_t i = 1; i < problem.poses.size(); ++i) {
    const Eigen::AngleAxisd rotation(problem.poses[i].camera_from_world.linear());
    x.segment<6>(static_cast<Eigen::Index>(6 * (i - 1))) << rotation.angle() * rotation.axis(),
        problem.poses[i].camera_from_world.translation();
  }
  for (std::size_t j = 0; j < problem.points.size(); ++j) {
    x.segment<3>(static_cast<Eigen::Index>(6 * 3 + 3 * j)) = problem.points[j];
  }
  Eigen::VectorXd residuals(oracle.values());
  oracle(x, residuals);
  EXPECT_NEAR(solution.initial_cost, residuals.squaredNorm(), 1e-9 * residuals.squaredNorm());
  Eigen::NumericalDiff<Oracle, Eigen::Central> differentiated(oracle);
  Eigen::LevenbergMarquardt<Eigen::NumericalDiff<Oracle, Eigen::Central>> solver(differentiated);
  solver.minimize(x);
  oracle(x, residuals);
  EXPECT_NEAR(solution.final_cost, residuals.squaredNorm(), 1e-6 * residuals.squaredNorm());
  for (std::size_t j = 0; j < problem.points.size(); ++j) {
    const Eigen::Vector3d expected = x.segment<3>(static_cast<Eigen::Index>(6 * 3 + 3 * j));
    EXPECT_LT((solution.points[j] - expected).norm(), 1e-4);
  }
}

// 3 of 300 observations are off by 30 px, which is 30 sigma; all others agree with the truth
// within rounding, so that the inliers are exactly the others.
TEST(BundleAdjustment, LeavesOutliersOutAndIsNotMovedByThem) {
  const BundleScene scene = makeBundleScene(5, 6, 60, 5, 0.0);
  BundleProblem problem = disturbed(scene.truth, 6, 0.005, 0.01);
  for (const std::size_t k : {17U, 101U, 250U}) {
    problem.observations[k].u += 30.0f;
  }
  BundleOptions options;
  options.max_iterations = 50;
  options.function_tolerance = 1e-12;
  const BundleSolution solution = adjustBundle(problem, options);
  EXPECT_EQ(solution.termination, BundleTermination::kConverged) << solution.message;
  for (std::size_t k = 0; k < problem.observations.size(); ++k) {
    EXPECT_EQ(solution.inlier[k] == 0, k == 17 || k == 101 || k == 250) << k;
  }
  EXPECT_EQ(solution.inliers, 297U);
  EXPECT_LT(largestPoseError(solution.poses, scene.truth), 1e-5);
}

TEST(BundleAdjustment, LowersTheErrorOfANoisyMap) {
  const BundleScene scene = makeBundleScene(7, 10, 300, 6, 1.0);
  const BundleProblem problem = disturbed(scene.truth, 8, 0.01, 0.03);
  const BundleSolution solution = adjustBundle(problem);
  std::vector<Eigen::Isometry3d> before;
  for (const BundlePose& pose : problem.poses) {
    before.push_back(pose.camera_from_world);
  }
  EXPECT_LT(largestPoseError(solution.poses, scene.truth),
            0.25 * largestPoseError(before, scene.truth));
  // Of 1800 residuals of 3 rows about 5 % lie beyond 95 % of chi2; fitting takes some of it away.
  EXPECT_GT(solution.inliers, 0.93 * 1800);
  EXPECT_LT(solution.inliers, 1800U);
}

TEST(BundleAdjustment, FixedPosesDoNotMoveByABit) {
  BundleScene scene = makeBundleScene(9, 6, 80, 4, 1.0);
  scene.truth.poses[3].fixed = true;
  const BundleProblem problem = disturbed(scene.truth, 10, 0.01, 0.02);
  const BundleSolution solution = adjustBundle(problem);
  for (const std::size_t i : {0U, 3U}) {
    EXPECT_EQ(solution.poses[i].matrix(), problem.poses[i].camera_from_world.matrix());
  }
  EXPECT_NE(solution.poses[1].matrix(), problem.poses[1].camera_from_world.matrix());
}

TEST(BundleAdjustment, MovesPointsAloneWhereAllPosesAreFixed) {
  BundleScene scene = makeBundleScene(11, 4, 40, 3, 0.0);
  for (BundlePose& pose : scene.truth.poses) {
    pose.fixed = true;
  }
  const BundleSolution solution =
      adjustBundle(disturbed(scene.truth, 12, 0.0, 0.05), leastSquares());
  EXPECT_EQ(solution.termination, BundleTermination::kConverged) << solution.message;
  for (std::size_t j = 0; j < solution.points.size(); ++j) {
    EXPECT_LT((solution.points[j] - scene.truth.points[j]).norm(), 1e-5);
  }
}

TEST(BundleAdjustment, SameInputGivesTheSameResultBitForBit) {
  const BundleScene scene = makeBundleScene(13, 10, 200, 5, 1.0);
  const BundleProblem problem = disturbed(scene.truth, 14, 0.01, 0.02);
  for (const int dense : {100, 0}) {
    BundleOptions options;
    options.max_dense_poses = dense;
    const BundleSolution first = adjustBundle(problem, options);
    const BundleSolution second = adjustBundle(problem, options);
    for (std::size_t i = 0; i < first.poses.size(); ++i) {
      EXPECT_EQ(first.poses[i].matrix(), second.poses[i].matrix());
    }
    EXPECT_EQ(first.points, second.points);
    EXPECT_EQ(first.inlier, second.inlier);
    EXPECT_EQ(first.final_cost, second.final_cost);
  }
}

TEST(BundleAdjustment, WeightsOfAHalfScaleTheCostByAQuarterAndLeaveTheMinimumAlone) {
  const BundleScene scene = makeBundleScene(15, 5, 60, 4, 1.0);
  BundleProblem problem = disturbed(scene.truth, 16, 0.005, 0.01);
  BundleOptions options;
  options.depth_error.systematic_quadratic = 0.0f;  // its prior has no weight
  options.max_iterations = 50;
  options.function_tolerance = 1e-13;
  const BundleSolution whole = adjustBundle(problem, options);
  for (BundleObservation& observation : problem.observations) {
    observation.weight = 0.5f;
  }
  const BundleSolution half = adjustBundle(problem, options);
  EXPECT_NEAR(half.initial_cost, 0.25 * whole.initial_cost, 1e-9 * whole.initial_cost);
  EXPECT_NEAR(half.final_cost, 0.25 * whole.final_cost, 1e-7 * whole.final_cost);
  for (std::size_t i = 0; i < whole.poses.size(); ++i) {
    EXPECT_LT(test::poseDistance(whole.poses[i], half.poses[i]), 1e-6);
  }
}

TEST(BundleAdjustment, StopsBeforeTheFirstStepWhereItIsToldTo) {
  const BundleScene scene = makeBundleScene(17, 5, 60, 4, 1.0);
  const BundleProblem problem = disturbed(scene.truth, 18, 0.005, 0.01);
  const std::atomic<bool> stop{true};
  BundleOptions options;
  options.stop = &stop;
  const BundleSolution solution = adjustBundle(problem, options);
  EXPECT_EQ(solution.termination, BundleTermination::kStopped);
  EXPECT_EQ(solution.points, problem.points);
  EXPECT_EQ(solution.iterations, 0);
}

TEST(BundleAdjustment, AStopFlagThatStaysDownChangesNothing) {
  const BundleScene scene = makeBundleScene(19, 5, 60, 4, 1.0);
  const BundleProblem problem = disturbed(scene.truth, 20, 0.005, 0.01);
  const std::atomic<bool> stop{false};
  BundleOptions options;
  const BundleSolution expected = adjustBundle(problem, options);
  options.stop = &stop;
  const BundleSolution solution = adjustBundle(problem, options);
  EXPECT_EQ(solution.points, expected.points);
  EXPECT_EQ(solution.termination, expected.termination);
}

}  // namespace
}  // namespace hmcdyn::slam

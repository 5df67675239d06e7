// SPDX-License-Identifier: BSD-3-Clause
// Bundle adjustment with input that cannot be solved, or not all of it.
#include <limits>
#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include "invalid_argument.hpp"
#include "map/bundle_scene.hpp"
#include "slam/map/bundle_adjustment.hpp"

namespace hmcdyn::slam {
namespace {

using hmcdyn::test::invalidArgumentOf;
using test::BundleScene;
using test::disturbed;
using test::largestPoseError;
using test::makeBundleScene;
using test::thorough;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

TEST(BundleInput, NothingAtAllIsNothingToDo) {
  BundleProblem problem;
  problem.camera = {500.0, 500.0, 320.0, 240.0};
  const BundleSolution solution = adjustBundle(problem);
  EXPECT_EQ(solution.termination, BundleTermination::kNothingToDo);
  EXPECT_TRUE(solution.poses.empty());
}

TEST(BundleInput, WithoutObservationsEverythingStays) {
  const BundleScene scene = makeBundleScene(1, 3, 10, 2, 0.0);
  BundleProblem problem = scene.truth;
  problem.observations.clear();
  const BundleSolution solution = adjustBundle(problem);
  EXPECT_EQ(solution.termination, BundleTermination::kNothingToDo);
  EXPECT_EQ(solution.points, problem.points);
  EXPECT_EQ(solution.poses[2].matrix(), problem.poses[2].camera_from_world.matrix());
}

TEST(BundleInput, PointSeenOnceWithoutDepthStaysAndMovesNothing) {
  const BundleScene scene = makeBundleScene(2, 5, 60, 4, 1.0);
  const BundleProblem without = disturbed(scene.truth, 3, 0.005, 0.01);
  BundleProblem with = without;
  with.points.emplace_back(0.1, 0.1, 2.0);
  BundleObservation once;
  once.pose = 1;
  once.point = 60;
  once.u = 500.0f;
  once.v = 10.0f;
  with.observations.push_back(once);
  const BundleSolution expected = adjustBundle(without);
  const BundleSolution solution = adjustBundle(with);
  EXPECT_EQ(solution.points.back(), Eigen::Vector3d(0.1, 0.1, 2.0));
  EXPECT_EQ(solution.inlier.back(), 0);  // it projects elsewhere
  EXPECT_EQ(solution.points[7], expected.points[7]);
  EXPECT_EQ(solution.poses[1].matrix(), expected.poses[1].matrix());
}

TEST(BundleInput, PointSeenOnceWithDepthGoesWhereItWasSeen) {
  const BundleScene scene = makeBundleScene(4, 5, 60, 4, 0.0);
  BundleProblem problem = disturbed(scene.truth, 5, 0.005, 0.01);
  problem.points.emplace_back(0.1, 0.1, 2.0);
  BundleObservation once;
  once.pose = 0;  // fixed
  once.point = 60;
  once.u = 400.0f;
  once.v = 200.0f;
  once.depth = 2.5f;
  problem.observations.push_back(once);
  const BundleSolution solution = adjustBundle(problem, thorough());
  const Eigen::Vector3d expected =
      problem.poses[0].camera_from_world.inverse() *
      Eigen::Vector3d((400.0 - 320.1) / 535.4 * 2.5, (200.0 - 247.6) / 539.2 * 2.5, 2.5);
  EXPECT_LT((solution.points.back() - expected).norm(), 1e-5);
}

TEST(BundleInput, ObservationFromBehindItsCameraIsNoInlierAndMovesNothing) {
  const BundleScene scene = makeBundleScene(6, 5, 60, 4, 0.0);
  BundleProblem problem = disturbed(scene.truth, 7, 0.005, 0.01);
  problem.points.emplace_back(0.0, 0.0, -2.0);
  for (int pose = 0; pose < 3; ++pose) {
    BundleObservation observation;
    observation.pose = pose;
    observation.point = 60;
    observation.u = 320.0f;
    observation.v = 240.0f;
    observation.depth = 2.0f;
    problem.observations.push_back(observation);
  }
  const BundleSolution solution = adjustBundle(problem, thorough());
  EXPECT_EQ(solution.points.back(), Eigen::Vector3d(0.0, 0.0, -2.0));
  EXPECT_EQ(solution.inliers, scene.truth.observations.size());
  EXPECT_LT(largestPoseError(solution.poses, scene.truth), 1e-5);
}

TEST(BundleInput, NotANumberIsLeftOutAndCounted) {
  const BundleScene scene = makeBundleScene(8, 5, 60, 4, 0.0);
  BundleProblem problem = disturbed(scene.truth, 9, 0.005, 0.01);
  problem.observations[5].u = kNaN;
  problem.observations[11].v = kInfinity;
  problem.observations[20].depth = kNaN;  // only no depth
  problem.points[59].x() = kNaN;          // has 4 observations
  const BundleSolution solution = adjustBundle(problem, thorough());
  EXPECT_EQ(solution.not_finite, 6U);
  EXPECT_EQ(solution.inliers, 240U - 6U);
  EXPECT_LT(largestPoseError(solution.poses, scene.truth), 1e-5);
  for (std::size_t j = 0; j + 1 < solution.points.size(); ++j) {
    EXPECT_TRUE(solution.points[j].allFinite());
  }
}

TEST(BundleInput, WithoutAFixedPoseTheFirstUsedOneIsHeld) {
  BundleScene scene = makeBundleScene(10, 5, 60, 4, 0.0);
  scene.truth.poses[0].fixed = false;
  BundleProblem problem = scene.truth;
  for (std::size_t i = 1; i < 5; ++i) {
    problem.poses[i].camera_from_world =
        test::moved(problem.poses[i].camera_from_world, {0.01, 0.0, -0.01}, {0.01, 0.02, 0.0});
  }
  const BundleSolution solution = adjustBundle(problem, thorough());
  EXPECT_EQ(solution.poses[0].matrix(), problem.poses[0].camera_from_world.matrix());
  EXPECT_LT(largestPoseError(solution.poses, scene.truth), 1e-5);
}

TEST(BundleInput, PoseThatSeesTwoPointsStays) {
  BundleScene scene = makeBundleScene(11, 5, 60, 4, 0.0);
  BundlePose lonely;
  lonely.camera_from_world = scene.truth.poses[2].camera_from_world;
  scene.truth.poses.push_back(lonely);
  BundleProblem problem = disturbed(scene.truth, 12, 0.005, 0.01);
  for (const int point : {3, 4}) {
    BundleObservation observation;
    observation.pose = 5;
    observation.point = point;
    observation.u = 100.0f;
    observation.v = 100.0f;
    problem.observations.push_back(observation);
  }
  const BundleSolution solution = adjustBundle(problem, thorough());
  EXPECT_EQ(solution.poses[5].matrix(), problem.poses[5].camera_from_world.matrix());
}

TEST(BundleInput, WeightZeroHasNoInfluenceAtAll) {
  const BundleScene scene = makeBundleScene(13, 5, 60, 4, 1.0);
  BundleProblem problem = disturbed(scene.truth, 14, 0.005, 0.01);
  const BundleSolution expected = adjustBundle(problem);
  BundleObservation nothing = problem.observations[3];
  nothing.u += 100.0f;
  nothing.weight = 0.0f;
  problem.observations.push_back(nothing);
  const BundleSolution solution = adjustBundle(problem);
  EXPECT_EQ(solution.points, expected.points);
  EXPECT_EQ(solution.inlier.back(), 0);
}

TEST(BundleInput, MistakesAreNamed) {
  const BundleScene scene = makeBundleScene(15, 3, 10, 2, 0.0);
  const auto complaint = [&scene](const auto& spoil) {
    return invalidArgumentOf([&] {
      BundleProblem problem = scene.truth;
      BundleOptions options;
      spoil(problem, options);
      adjustBundle(problem, options);
    });
  };
  using Problem = BundleProblem;
  using Options = BundleOptions;
  EXPECT_EQ(complaint([](Problem& p, Options&) { p.observations[4].point = 10; }),
            "observations[4].point is 10, expected an index below 10");
  EXPECT_EQ(complaint([](Problem& p, Options&) { p.observations[4].pose = -1; }),
            "observations[4].pose is -1, expected an index below 3");
  EXPECT_EQ(complaint([](Problem& p, Options&) { p.observations[0].sigma = 0.0f; }),
            "observations[0].sigma is 0.000000, expected finite and > 0");
  EXPECT_EQ(complaint([](Problem& p, Options&) { p.observations[0].weight = -1.0f; }),
            "observations[0].weight is -1.000000, expected finite and >= 0");
  EXPECT_EQ(complaint([](Problem& p, Options&) {
              p.poses[1].camera_from_world.translation().x() = kNaN;
            }),
            "poses[1] is not finite, expected a rigid motion");
  EXPECT_EQ(complaint([](Problem& p, Options&) { p.camera.fx = 0.0; }),
            "camera.fx is 0.000000, expected finite and > 0");
  EXPECT_EQ(complaint([](Problem&, Options& o) { o.plain_rounds = 3; }),
            "options.plain_rounds is 3, expected 0..options.rounds, 2");
  EXPECT_EQ(complaint([](Problem&, Options& o) { o.threads = 0; }),
            "options.threads is 0, expected at least 1");
}

}  // namespace
}  // namespace hmcdyn::slam

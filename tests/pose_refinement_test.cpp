// SPDX-License-Identifier: BSD-3-Clause
// What a correct refinement must satisfy: exact recovery, and how the result moves with its input.
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <hmcdyn/pose_refinement.hpp>

#include "pose_scene.hpp"

namespace hmcdyn {
namespace {

using test::disturbed;
using test::makePoseScene;
using test::motionBetween;
using test::moved;
using test::observe;
using test::PoseScene;

/// One optimisation without robust loss: plain least squares.
PoseRefinementOptions leastSquares() {
  PoseRefinementOptions options;
  options.loss = RobustLoss::kNone;
  options.rounds = 1;
  options.plain_rounds = 0;
  return options;
}

/// A scene in which every number is a float: quarter turns, powers of two, pixels on a grid.
PoseScene exactScene() {
  PoseScene scene;
  scene.camera = {512.0, 256.0, 320.0, 240.0};
  scene.camera_from_world.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  scene.camera_from_world.translation() << 0.5, -0.25, 1.0;
  for (int k = 0; k < 60; ++k) {
    const double depth = std::array<double, 3>{1.0, 2.0, 4.0}.at(static_cast<std::size_t>(k % 3));
    const double u = 10.0 * k + 15.0;
    const double v = (37 * k) % 480;
    const Eigen::Vector3d world =
        scene.camera_from_world.linear().transpose() *
        (scene.camera.unproject(u, v, depth) - scene.camera_from_world.translation());
    scene.x.push_back(static_cast<float>(world.x()));
    scene.y.push_back(static_cast<float>(world.y()));
    scene.z.push_back(static_cast<float>(world.z()));
    scene.u.push_back(static_cast<float>(u));
    scene.v.push_back(static_cast<float>(v));
    scene.depth.push_back(static_cast<float>(depth));
  }
  return scene;
}

class ExactPose : public ::testing::TestWithParam<DepthRow> {};

TEST_P(ExactPose, IsRecoveredFromCorrespondencesThatFloatsHoldExactly) {
  const PoseScene scene = exactScene();
  PoseRefinementOptions options;
  options.depth_row = GetParam();
  const auto result = refinePose(scene.view(), scene.camera, disturbed(scene), options);
  EXPECT_EQ(result.termination, PoseRefinementTermination::kConverged) << result.message;
  EXPECT_LT(motionBetween(result.camera_from_world, scene.camera_from_world).norm(), 1e-9);
  EXPECT_EQ(result.inliers, scene.size());
  EXPECT_EQ(result.usable_points, scene.size());
  EXPECT_LT(result.final_cost, 1e-15);
  EXPECT_GT(result.initial_cost, 1.0);
  EXPECT_TRUE(result.covariance.has_value());
}

INSTANTIATE_TEST_SUITE_P(AllRows, ExactPose,
                         ::testing::Values(DepthRow::kNone, DepthRow::kDepth,
                                           DepthRow::kDisparity));

// A pixel below 1024 is off by at most 2^-15 px in float. Least squares cannot leave larger
// residuals than the true pose does, so the two poses' projections differ by at most twice that.
TEST(PoseRefinement, RecoversARandomPoseToTheRoundingOfItsPixels) {
  for (const unsigned seed : {1U, 2U, 3U, 4U, 5U}) {
    const PoseScene scene = makePoseScene(seed, 200);
    const auto result =
        refinePose(scene.view(), scene.camera, disturbed(scene, 0.1, 0.2), leastSquares());
    ASSERT_TRUE(result.succeeded()) << result.message;
    double sum = 0.0;
    for (std::size_t i = 0; i < scene.size(); ++i) {
      const Eigen::Vector3d world(scene.x[i], scene.y[i], scene.z[i]);
      sum += (scene.camera.project(result.camera_from_world * world) -
              scene.camera.project(scene.camera_from_world * world))
                 .squaredNorm();
    }
    const double pixel_rounding = std::ldexp(1.0, -15);
    EXPECT_LT(std::sqrt(sum / (2.0 * 200.0)), 2.0 * pixel_rounding);
    EXPECT_LT(motionBetween(result.camera_from_world, scene.camera_from_world).norm(), 1e-6);
  }
}

TEST(PoseRefinement, CostIsTheWeightedRobustSumOfSquaredSigmas) {
  // Given the true pose as the start, and one point that is off by (3, 4) px with sigma 2 and
  // weight 0.5: squared residual (25 / 4) = 6.25, beyond Huber's threshold of 2.
  PoseScene scene = exactScene();
  scene.sigma.assign(scene.size(), 1.0f);
  scene.weight.assign(scene.size(), 1.0f);
  scene.u[7] += 3.0f;
  scene.v[7] += 4.0f;
  scene.sigma[7] = 2.0f;
  scene.weight[7] = 0.5f;
  PoseRefinementOptions options;
  options.huber_two_rows = 2.0;
  const auto robust = refinePose(scene.view(), scene.camera, scene.camera_from_world, options);
  EXPECT_NEAR(robust.initial_cost, 0.25 * (2.0 * 2.0 * 2.5 - 4.0), 1e-9);
  const auto plain =
      refinePose(scene.view(), scene.camera, scene.camera_from_world, leastSquares());
  EXPECT_NEAR(plain.initial_cost, 0.25 * 6.25, 1e-9);
}

TEST(PoseRefinement, PointOfWeightZeroHasNoInfluenceAtAll) {
  const PoseScene without = makePoseScene(11, 100, 1.0);
  PoseScene with = without;
  with.x.insert(with.x.begin() + 5, 1.0f);
  with.y.insert(with.y.begin() + 5, 2.0f);
  with.z.insert(with.z.begin() + 5, 3.0f);
  with.u.insert(with.u.begin() + 5, 1000.0f);
  with.v.insert(with.v.begin() + 5, -1000.0f);
  with.sigma.insert(with.sigma.begin() + 5, 0.01f);
  with.depth.insert(with.depth.begin() + 5, 9.0f);
  with.weight.insert(with.weight.begin() + 5, 0.0f);

  const Eigen::Isometry3d initial = disturbed(without);
  const auto expected = refinePose(without.view(), without.camera, initial);
  const auto result = refinePose(with.view(), with.camera, initial);

  EXPECT_EQ(result.camera_from_world, expected.camera_from_world);
  EXPECT_EQ(*result.covariance, *expected.covariance);
  EXPECT_EQ(result.final_cost, expected.final_cost);
  EXPECT_EQ(result.usable_points, 100U);
  EXPECT_EQ(result.inlier[5], 0);
}

TEST(PoseRefinement, SameInputGivesTheSameResultBitForBit) {
  const PoseScene scene = makePoseScene(12, 150, 1.0);
  const auto first = refinePose(scene.view(), scene.camera, disturbed(scene));
  const auto second = refinePose(scene.view(), scene.camera, disturbed(scene));
  EXPECT_EQ(first.camera_from_world, second.camera_from_world);
  EXPECT_EQ(*first.covariance, *second.covariance);
  EXPECT_EQ(first.inlier, second.inlier);
  EXPECT_EQ(first.message, second.message);
}

TEST(PoseRefinement, EmptyOptionalArraysMeanOnes) {
  const PoseScene scene = makePoseScene(13, 80, 1.0);
  PoseObservations bare = scene.view();
  bare.sigma = {};
  bare.depth = {};
  bare.weight = {};
  const auto result = refinePose(bare, scene.camera, disturbed(scene));
  const auto expected = refinePose(scene.view(), scene.camera, disturbed(scene));
  EXPECT_EQ(result.camera_from_world, expected.camera_from_world);
  EXPECT_EQ(result.weight, std::vector<float>(80, 1.0f));
}

class WeightScale : public ::testing::TestWithParam<float> {};

TEST_P(WeightScale, LeavesThePoseAloneAndScalesTheCostByItsSquare) {
  PoseScene scene = makePoseScene(14, 120, 1.0);
  std::mt19937 random(14);
  std::uniform_int_distribution<int> sixteenths(1, 16);
  for (float& weight : scene.weight) {
    weight = static_cast<float>(sixteenths(random)) / 16.0f;
  }
  const auto whole = refinePose(scene.view(), scene.camera, disturbed(scene));
  for (float& weight : scene.weight) {
    weight *= GetParam();
  }
  const auto scaled = refinePose(scene.view(), scene.camera, disturbed(scene));

  const double square = std::pow(static_cast<double>(GetParam()), 2);
  EXPECT_LT(motionBetween(whole.camera_from_world, scaled.camera_from_world).norm(), 1e-7);
  EXPECT_NEAR(scaled.initial_cost, square * whole.initial_cost, 1e-7 * whole.initial_cost);
  EXPECT_NEAR(scaled.final_cost, square * whole.final_cost, 1e-7 * whole.final_cost);
  EXPECT_EQ(scaled.inlier, whole.inlier);
  EXPECT_TRUE((square * scaled.covariance->map()).isApprox(whole.covariance->map(), 1e-5));
}

INSTANTIATE_TEST_SUITE_P(Factors, WeightScale, ::testing::Values(0.5f, 0.3f, 0.01f));

TEST(PoseRefinement, AWeightCountsAsADeviationGrownByItsInverse) {
  // lambda = 1/4 with sigma = 1 weighs like lambda = 1 with sigma = 4: lambda^2 / sigma^2.
  PoseScene weighted = makePoseScene(15, 100, 1.0);
  PoseScene widened = weighted;
  for (std::size_t i = 0; i < 50; ++i) {
    weighted.weight[i] = 0.25f;
    widened.sigma[i] = 4.0f;
  }
  const auto by_weight =
      refinePose(weighted.view(), weighted.camera, disturbed(weighted), leastSquares());
  const auto by_sigma =
      refinePose(widened.view(), widened.camera, disturbed(widened), leastSquares());
  EXPECT_LT(motionBetween(by_weight.camera_from_world, by_sigma.camera_from_world).norm(), 1e-9);
  EXPECT_TRUE(by_weight.covariance->map().isApprox(by_sigma.covariance->map(), 1e-7));
}

TEST(PoseRefinement, MovesWithTheWorldFrame) {
  // Given a scene on a grid of 2^-12 m, so that a quarter turn and a shift stay exact in float,
  PoseScene scene = makePoseScene(16, 100);
  const auto snap = [](float value) { return std::ldexp(std::round(std::ldexp(value, 12)), -12); };
  std::transform(scene.x.begin(), scene.x.end(), scene.x.begin(), snap);
  std::transform(scene.y.begin(), scene.y.end(), scene.y.begin(), snap);
  std::transform(scene.z.begin(), scene.z.end(), scene.z.begin(), snap);
  std::mt19937 random(16);
  observe(scene, random, 1.0);
  PoseScene turned = scene;
  for (std::size_t i = 0; i < scene.size(); ++i) {
    turned.x[i] = -scene.y[i] + 8.0f;
    turned.y[i] = scene.x[i] - 4.0f;
    turned.z[i] = scene.z[i] + 2.0f;
  }
  Eigen::Isometry3d new_from_old = Eigen::Isometry3d::Identity();
  new_from_old.linear() << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  new_from_old.translation() << 8, -4, 2;

  // when it is told in the other frame,
  const Eigen::Isometry3d initial = disturbed(scene);
  const auto old_result = refinePose(scene.view(), scene.camera, initial);
  const auto new_result = refinePose(turned.view(), scene.camera, initial * new_from_old.inverse());

  // then the pose moves along, and nothing else changes: covariance is in the camera's frame.
  EXPECT_LT(motionBetween(new_result.camera_from_world * new_from_old, old_result.camera_from_world)
                .norm(),
            1e-10);
  EXPECT_TRUE(new_result.covariance->map().isApprox(old_result.covariance->map(), 1e-8));
  EXPECT_EQ(new_result.inlier, old_result.inlier);
  EXPECT_EQ(new_result.iterations, old_result.iterations);
}

TEST(PoseRefinement, OrderOfThePointsDoesNotMatter) {
  const PoseScene scene = makePoseScene(17, 120, 1.0);
  PoseScene reversed = scene;
  for (auto* values : {&reversed.x, &reversed.y, &reversed.z, &reversed.u, &reversed.v}) {
    std::reverse(values->begin(), values->end());
  }
  const auto expected = refinePose(scene.view(), scene.camera, disturbed(scene));
  auto result = refinePose(reversed.view(), scene.camera, disturbed(scene));
  EXPECT_LT(motionBetween(result.camera_from_world, expected.camera_from_world).norm(), 1e-10);
  std::reverse(result.inlier.begin(), result.inlier.end());
  EXPECT_EQ(result.inlier, expected.inlier);
}

TEST(PoseRefinement, PointsWithoutDepthKeepTheirTwoRows) {
  // Given depths of which every other one is missing in one of three ways,
  PoseScene scene = exactScene();
  const std::array<float, 3> none{0.0f, -1.0f, kNaN};
  for (std::size_t i = 0; i < scene.size(); i += 2) {
    scene.depth[i] = none.at(i / 2 % 3);
  }
  for (const DepthRow row : {DepthRow::kDepth, DepthRow::kDisparity}) {
    PoseRefinementOptions options;
    options.depth_row = row;
    const auto result = refinePose(scene.view(), scene.camera, disturbed(scene), options);
    EXPECT_EQ(result.inliers, scene.size());
    EXPECT_LT(motionBetween(result.camera_from_world, scene.camera_from_world).norm(), 1e-9);
  }
}

TEST(PoseRefinement, AWrongDepthMakesAnOutlierOnlyWithADepthRow) {
  PoseScene scene = exactScene();
  scene.depth[4] += 1.0f;
  PoseRefinementOptions options;
  EXPECT_EQ(refinePose(scene.view(), scene.camera, disturbed(scene), options).inlier[4], 1);
  for (const DepthRow row : {DepthRow::kDepth, DepthRow::kDisparity}) {
    options.depth_row = row;
    const auto result = refinePose(scene.view(), scene.camera, disturbed(scene), options);
    EXPECT_EQ(result.inlier[4], 0);
    EXPECT_EQ(result.inliers, scene.size() - 1);
    EXPECT_LT(motionBetween(result.camera_from_world, scene.camera_from_world).norm(), 1e-9);
  }
}

}  // namespace
}  // namespace hmcdyn

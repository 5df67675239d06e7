// SPDX-License-Identifier: BSD-3-Clause
// Outliers, points behind the camera, and input that cannot give a pose.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <string>
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
using test::PoseScene;

void appendPoint(PoseScene& scene, const Eigen::Vector3d& world, float u, float v) {
  scene.x.push_back(static_cast<float>(world.x()));
  scene.y.push_back(static_cast<float>(world.y()));
  scene.z.push_back(static_cast<float>(world.z()));
  scene.u.push_back(u);
  scene.v.push_back(v);
  scene.sigma.push_back(1.0f);
  scene.depth.push_back(0.0f);
  scene.weight.push_back(1.0f);
}

bool isFinite(const PoseRefinementResult& result) {
  return result.camera_from_world.matrix.map().allFinite() && std::isfinite(result.initial_cost) &&
         std::isfinite(result.final_cost) &&
         (!result.covariance || result.covariance->map().allFinite()) &&
         std::all_of(result.weight.begin(), result.weight.end(),
                     [](float weight) { return std::isfinite(weight); });
}

void expectInitialPose(const PoseRefinementResult& result, const Eigen::Isometry3d& initial,
                       PoseRefinementTermination why) {
  EXPECT_EQ(result.termination, why) << result.message;
  EXPECT_FALSE(result.succeeded());
  EXPECT_EQ(result.camera_from_world, Pose(initial));
  EXPECT_FALSE(result.covariance);
  EXPECT_EQ(result.inliers, 0U);
  EXPECT_EQ(std::count(result.inlier.begin(), result.inlier.end(), 1), 0);
  EXPECT_TRUE(isFinite(result));
  EXPECT_EQ(result.message.rfind(toString(why), 0), 0U) << result.message;
}

class ThirtyPercentOutliers : public ::testing::TestWithParam<unsigned> {};

TEST_P(ThirtyPercentOutliers, LeaveThePoseOfTheOthers) {
  // Given 300 points with 1 px of noise, 90 of them with a pixel anywhere in the image,
  PoseScene scene = makePoseScene(GetParam(), 300, 1.0);
  std::mt19937 random(GetParam());
  std::uniform_real_distribution<float> column(0.0f, 640.0f);
  std::uniform_real_distribution<float> row(0.0f, 480.0f);
  PoseScene good = scene;
  for (std::size_t i = 0; i < 90; ++i) {
    scene.u[i] = column(random);
    scene.v[i] = row(random);
    good.weight[i] = 0.0f;
  }
  std::vector<double> wrong;  // how far the outliers are from where they belong (px)
  for (std::size_t i = 0; i < 90; ++i) {
    wrong.push_back(std::hypot(scene.u[i] - good.u[i], scene.v[i] - good.v[i]));
  }

  // when it is refined from a start some 10 px off,
  const auto result = refinePose(scene.view(), scene.camera, disturbed(scene));
  const auto expected = refinePose(good.view(), scene.camera, disturbed(scene));

  // then the pose is that of the good points alone, to a fraction of its own uncertainty,
  ASSERT_TRUE(result.succeeded()) << result.message;
  const auto delta = motionBetween(result.camera_from_world, expected.camera_from_world);
  EXPECT_LT(delta.dot(expected.covariance->map().ldlt().solve(delta)), 1.0);
  // and the outliers are known, but for those that fell near their place.
  for (std::size_t i = 0; i < 90; ++i) {
    if (wrong[i] > 10.0) {
      EXPECT_EQ(result.inlier[i], 0) << "point " << i << " is " << wrong[i] << " px off";
    }
  }
  EXPECT_GT(std::count(result.inlier.begin() + 90, result.inlier.end(), 1), 190);
}

INSTANTIATE_TEST_SUITE_P(Seeds, ThirtyPercentOutliers, ::testing::Range(1U, 11U));

TEST(PoseRefinementRobust, HuberAloneResistsWhatLeastSquaresDoesNot) {
  PoseScene scene = makePoseScene(21, 200, 0.5);
  for (std::size_t i = 0; i < 40; ++i) {
    scene.u[i] += 30.0f;
  }
  PoseRefinementOptions options;
  options.rounds = 1;
  options.plain_rounds = 0;
  const auto error = [&scene](const PoseRefinementOptions& with) {
    return motionBetween(
               refinePose(scene.view(), scene.camera, disturbed(scene), with).camera_from_world,
               scene.camera_from_world)
        .norm();
  };
  const double huber = error(options);
  options.loss = RobustLoss::kNone;
  EXPECT_LT(huber, 0.2 * error(options));
}

TEST(PoseRefinementRobust, ASmallWeightDoesNotHideAnOutlier) {
  // Given a point 10 sigma off with weight 0.1: weighted, its residual would be 1 sigma,
  PoseScene scene = makePoseScene(22, 100);
  scene.u[3] += 10.0f;
  scene.weight[3] = 0.1f;
  const auto result = refinePose(scene.view(), scene.camera, disturbed(scene));
  // then it is an outlier all the same, and the pose is exact to the pixels' rounding.
  EXPECT_EQ(result.inlier[3], 0);
  EXPECT_EQ(result.inliers, 99U);
  EXPECT_LT(motionBetween(result.camera_from_world, scene.camera_from_world).norm(), 1e-6);
}

TEST(PoseRefinementRobust, SigmaScalesTheOutlierTest) {
  PoseScene scene = makePoseScene(23, 100);
  scene.u[3] += 10.0f;
  scene.sigma[3] = 8.0f;  // 1.25 sigma
  const auto result = refinePose(scene.view(), scene.camera, disturbed(scene));
  EXPECT_EQ(result.inlier[3], 1);
}

TEST(PoseRefinementRobust, APointBehindTheFirstCameraComesBack) {
  // Given a start 1.5 m too far ahead, so that a point 1 m from the true camera lies behind it,
  PoseScene scene = makePoseScene(24, 0);
  for (int k = 0; k < 40; ++k) {
    const double u = 20.0 + 15.0 * k;
    const double v = (61 * k) % 480;
    const double z = k == 0 ? 1.0 : 4.0 + 0.1 * k;
    appendPoint(scene, scene.camera_from_world.inverse() * scene.camera.unproject(u, v, z),
                static_cast<float>(u), static_cast<float>(v));
  }
  const Eigen::Isometry3d initial =
      moved(scene.camera_from_world, Eigen::Vector3d::Zero(), Eigen::Vector3d(0.0, 0.0, -1.5));
  const auto result = refinePose(scene.view(), scene.camera, initial);
  EXPECT_EQ(result.usable_points, 39U);
  EXPECT_EQ(result.inlier[0], 1);
  EXPECT_EQ(result.inliers, 40U);
  EXPECT_LT(motionBetween(result.camera_from_world, scene.camera_from_world).norm(), 1e-5);
}

TEST(PoseRefinementRobust, PointsBehindTheCameraStayOut) {
  PoseScene scene = makePoseScene(25, 60);
  const PoseScene without = scene;
  // Mirrored through the camera's centre a point has the same pixel, and is behind.
  appendPoint(scene, scene.camera_from_world.inverse() * scene.camera.unproject(100, 100, -2.0),
              100.0f, 100.0f);
  const auto result = refinePose(scene.view(), scene.camera, disturbed(scene));
  const auto expected = refinePose(without.view(), scene.camera, disturbed(scene));
  EXPECT_EQ(result.usable_points, 60U);
  EXPECT_EQ(result.inlier.back(), 0);
  EXPECT_EQ(result.camera_from_world, expected.camera_from_world);
}

TEST(PoseRefinementRobust, NotFinitePointsAreSkippedAndCounted) {
  const PoseScene without = makePoseScene(26, 60, 1.0);
  PoseScene scene = without;
  const float infinity = std::numeric_limits<float>::infinity();
  appendPoint(scene, {kNaN, 0.0, 1.0}, 1.0f, 1.0f);
  appendPoint(scene, {0.0, infinity, 1.0}, 1.0f, 1.0f);
  appendPoint(scene, {0.0, 0.0, kNaN}, 1.0f, 1.0f);
  appendPoint(scene, {0.0, 0.0, 1.0}, kNaN, 1.0f);
  appendPoint(scene, {0.0, 0.0, 1.0}, 1.0f, -infinity);
  const auto result = refinePose(scene.view(), scene.camera, disturbed(without));
  const auto expected = refinePose(without.view(), scene.camera, disturbed(without));
  EXPECT_EQ(result.skipped_points, 5U);
  EXPECT_EQ(result.usable_points, 60U);
  EXPECT_EQ(result.inlier.size(), 65U);
  EXPECT_EQ(result.camera_from_world, expected.camera_from_world);
}

TEST(PoseRefinementRobust, FewerThanThreeUsablePointsGiveTheInitialPose) {
  const PoseScene whole = makePoseScene(27, 2);
  const Eigen::Isometry3d initial = disturbed(whole);
  const auto two = refinePose(whole.view(), whole.camera, initial);
  expectInitialPose(two, initial, PoseRefinementTermination::kTooFewPoints);
  EXPECT_EQ(two.usable_points, 2U);
  EXPECT_NE(two.message.find("2 points"), std::string::npos) << two.message;

  const auto none = refinePose({}, whole.camera, initial);
  expectInitialPose(none, initial, PoseRefinementTermination::kTooFewPoints);

  PoseScene weightless = makePoseScene(28, 50);
  weightless.weight.assign(50, 0.0f);
  expectInitialPose(refinePose(weightless.view(), weightless.camera, initial), initial,
                    PoseRefinementTermination::kTooFewPoints);

  const PoseScene behind = makePoseScene(29, 50);
  const Eigen::Isometry3d backwards =
      moved(behind.camera_from_world, Eigen::Vector3d(0.0, M_PI, 0.0), Eigen::Vector3d::Zero());
  expectInitialPose(refinePose(behind.view(), behind.camera, backwards), backwards,
                    PoseRefinementTermination::kTooFewPoints);
}

TEST(PoseRefinementRobust, ThreePointsAreEnough) {
  PoseScene scene = makePoseScene(30, 0);
  for (const Eigen::Vector3d& at : {Eigen::Vector3d(100, 100, 2.0), Eigen::Vector3d(500, 150, 3.0),
                                    Eigen::Vector3d(300, 400, 2.5)}) {
    appendPoint(scene,
                scene.camera_from_world.inverse() * scene.camera.unproject(at.x(), at.y(), at.z()),
                static_cast<float>(at.x()), static_cast<float>(at.y()));
  }
  const auto result = refinePose(scene.view(), scene.camera, disturbed(scene));
  EXPECT_TRUE(result.succeeded()) << result.message;
  EXPECT_EQ(result.inliers, 3U);
  EXPECT_LT(motionBetween(result.camera_from_world, scene.camera_from_world).norm(), 1e-5);
}

TEST(PoseRefinementRobust, PointsOnALineGiveAPoseWithoutCovariance) {
  // The turn about the line through the points is not determined.
  PoseScene scene = makePoseScene(31, 0);
  scene.camera_from_world = Eigen::Isometry3d::Identity();
  for (int k = 0; k < 20; ++k) {
    const Eigen::Vector3d world(-1.0 + 0.125 * k, 0.25, 2.0);
    const Eigen::Vector2d pixel = scene.camera.project(world);
    appendPoint(scene, world, static_cast<float>(pixel.x()), static_cast<float>(pixel.y()));
  }
  const auto result = refinePose(scene.view(), scene.camera, scene.camera_from_world);
  EXPECT_TRUE(result.succeeded()) << result.message;
  EXPECT_TRUE(isFinite(result));
  EXPECT_FALSE(result.covariance);
  EXPECT_EQ(result.inliers, 20U);
}

TEST(PoseRefinementRobust, OnePointManyTimesGivesAPoseWithoutCovariance) {
  PoseScene scene = makePoseScene(32, 0);
  for (int k = 0; k < 10; ++k) {
    appendPoint(scene, scene.camera_from_world.inverse() * Eigen::Vector3d(0.1, 0.2, 2.0), 350.0f,
                300.0f);
  }
  const auto result = refinePose(scene.view(), scene.camera, disturbed(scene));
  EXPECT_TRUE(isFinite(result));
  EXPECT_FALSE(result.covariance);
}

TEST(PoseRefinementRobust, PointsThatAgreeOnNothingGiveTheInitialPose) {
  PoseScene scene = makePoseScene(33, 40);
  std::reverse(scene.u.begin(), scene.u.end());
  scene.sigma.assign(40, 0.001f);
  const Eigen::Isometry3d initial = disturbed(scene);
  expectInitialPose(refinePose(scene.view(), scene.camera, initial), initial,
                    PoseRefinementTermination::kTooFewInliers);
}

TEST(PoseRefinementRobust, AnOverflowGivesTheInitialPose) {
  // Finite and positive, but squared residuals are not.
  PoseScene scene = makePoseScene(34, 40, 1.0);
  scene.camera.fx = 1e200;
  const Eigen::Isometry3d initial = disturbed(scene);
  expectInitialPose(refinePose(scene.view(), scene.camera, initial), initial,
                    PoseRefinementTermination::kNumericalFailure);
}

TEST(PoseRefinementRobust, CoordinatesOfAnySizeLeaveTheResultFinite) {
  PoseScene scene = makePoseScene(35, 40, 1.0);
  const Eigen::Isometry3d initial = disturbed(scene);
  scene.x[0] = 3e38f;
  scene.y[1] = -3e38f;
  scene.z[2] = 3e38f;
  scene.u[3] = 3e38f;
  scene.sigma[4] = 1e-30f;
  scene.sigma[5] = 1e30f;
  EXPECT_TRUE(isFinite(refinePose(scene.view(), scene.camera, initial)));
}

TEST(PoseRefinementRobust, StopsAtTheIterationLimitWithALowerCost) {
  const PoseScene scene = makePoseScene(36, 100, 1.0);
  PoseRefinementOptions options;
  options.rounds = 1;
  options.plain_rounds = 0;
  options.max_iterations = 1;
  const auto result = refinePose(scene.view(), scene.camera, disturbed(scene, 0.1, 0.2), options);
  EXPECT_EQ(result.termination, PoseRefinementTermination::kIterationLimit) << result.message;
  EXPECT_TRUE(result.succeeded());
  EXPECT_EQ(result.iterations, 1);
  EXPECT_LT(result.final_cost, result.initial_cost);
}

TEST(PoseRefinementRobust, EndsEarlyWhenNothingChanges) {
  // Exact points: all inliers at once. One robust and one plain round, and no more.
  const PoseScene scene = makePoseScene(37, 100);
  PoseRefinementOptions options;
  options.rounds = 10;
  EXPECT_EQ(refinePose(scene.view(), scene.camera, disturbed(scene), options).rounds, 2);
  options.plain_rounds = 0;
  EXPECT_EQ(refinePose(scene.view(), scene.camera, disturbed(scene), options).rounds, 1);
}

TEST(PoseRefinementRobust, WritesNothingToTheTerminal) {
  PoseScene scene = makePoseScene(38, 40, 1.0);
  const Eigen::Isometry3d initial = disturbed(scene);
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  refinePose(scene.view(), scene.camera, initial);
  scene.camera.fx = 1e200;
  refinePose(scene.view(), scene.camera, initial);
  scene.camera.fx = 500.0;
  scene.x.assign(40, scene.x[0]);
  refinePose(scene.view(), scene.camera, initial);
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace hmcdyn

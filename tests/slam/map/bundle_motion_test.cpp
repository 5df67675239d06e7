// SPDX-License-Identifier: BSD-3-Clause
// Bundle adjustment with what is known of the camera's motion between key frames.
#include <cmath>
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
using test::moved;
using test::poseDistance;
using test::thorough;

using Matrix6 = Eigen::Matrix<double, 6, 6>;

BundleMotion motionBetween(const BundleProblem& problem, int from, int to, double sigma) {
  BundleMotion motion;
  motion.from = from;
  motion.to = to;
  motion.to_from = problem.poses[static_cast<std::size_t>(to)].camera_from_world *
                   problem.poses[static_cast<std::size_t>(from)].camera_from_world.inverse();
  motion.information = Matrix6::Identity() / (sigma * sigma);
  return motion;
}

TEST(BundleMotion, TrueMotionsLeaveAnExactResultAlone) {
  const BundleScene scene = makeBundleScene(1, 6, 120, 4, 0.0);
  BundleProblem problem = disturbed(scene.truth, 2, 0.02, 0.05);
  for (int k = 1; k < 6; ++k) {
    problem.motions.push_back(motionBetween(scene.truth, k - 1, k, 0.001));
  }
  const BundleSolution solution = adjustBundle(problem, thorough());
  EXPECT_EQ(solution.termination, BundleTermination::kConverged) << solution.message;
  EXPECT_LT(largestPoseError(solution.poses, scene.truth), 2e-6);
}

TEST(BundleMotion, ACertainMotionIsKeptAndAVagueOneIsOverruled) {
  const BundleScene scene = makeBundleScene(3, 4, 100, 3, 0.5);
  BundleProblem problem = scene.truth;
  const Eigen::Isometry3d wrong =
      moved(motionBetween(scene.truth, 1, 2, 1.0).to_from, {0.0, 0.01, 0.0}, {0.05, 0.0, 0.0});
  BundleOptions options = thorough();
  options.rounds = 1;  // all observations stay
  for (const double sigma : {1e-6, 1e3}) {
    BundleMotion motion = motionBetween(scene.truth, 1, 2, sigma);
    motion.to_from = wrong;
    problem.motions = {motion};
    const BundleSolution solution = adjustBundle(problem, options);
    const Eigen::Isometry3d found = solution.poses[2] * solution.poses[1].inverse();
    problem.motions.clear();
    const BundleSolution without = adjustBundle(problem, options);
    const Eigen::Isometry3d seen = without.poses[2] * without.poses[1].inverse();
    EXPECT_LT(poseDistance(found, sigma < 1.0 ? wrong : seen), 1e-5) << "sigma " << sigma;
    EXPECT_GT(poseDistance(wrong, seen), 0.03);
  }
}

TEST(BundleMotion, MotionsMakeUpForFewPoints) {
  double with = 0.0;
  double without = 0.0;
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const BundleScene noisy = makeBundleScene(seed, 5, 12, 5, 1.0);
    BundleProblem problem = noisy.truth;  // true poses and points, observations with noise
    without += largestPoseError(adjustBundle(problem, thorough()).poses, noisy.truth);
    for (int k = 1; k < 5; ++k) {
      problem.motions.push_back(motionBetween(noisy.truth, k - 1, k, 0.002));
    }
    with += largestPoseError(adjustBundle(problem, thorough()).poses, noisy.truth);
  }
  EXPECT_LT(with, 0.7 * without) << "sums over 20 scenes, with motions and without";
}

TEST(BundleMotion, OfAKeyFrameWithoutObservationsIsLeftOut) {
  const BundleScene scene = makeBundleScene(2, 4, 80, 3, 0.0);
  BundleProblem problem = scene.truth;
  const Eigen::Isometry3d blind = moved(Eigen::Isometry3d::Identity(), {0.1, 0.0, 0.0}, {1, 2, 3});
  problem.poses.push_back({blind, false});
  problem.motions.push_back(motionBetween(scene.truth, 0, 1, 0.001));
  problem.motions.back().to = 4;
  const BundleSolution solution = adjustBundle(problem, thorough());
  EXPECT_EQ((solution.poses[4].matrix() - blind.matrix()).norm(), 0.0);
  EXPECT_LT(poseDistance(solution.poses[3], scene.truth.poses[3].camera_from_world), 2e-6);
}

TEST(BundleMotion, WhatCannotBeUsedIsNamed) {
  const BundleScene scene = makeBundleScene(2, 3, 40, 3, 0.0);
  const auto message = [&](auto spoil) {
    BundleProblem problem = scene.truth;
    problem.motions.push_back(motionBetween(scene.truth, 0, 1, 0.01));
    spoil(problem.motions.back());
    return invalidArgumentOf([&] { adjustBundle(problem); });
  };
  EXPECT_EQ(message([](BundleMotion&) {}), "nothing thrown");
  EXPECT_EQ(message([](BundleMotion& m) { m.to = 3; }),
            "motions[0].to is 3, expected an index below 3");
  EXPECT_EQ(message([](BundleMotion& m) { m.to = 0; }),
            "motions[0].to is 0, expected another than from");
  EXPECT_EQ(message([](BundleMotion& m) { m.from = -1; }),
            "motions[0].from is -1, expected an index below 3");
  EXPECT_EQ(message([](BundleMotion& m) { m.information(0, 1) = 1.0; }),
            "motions[0].information is not symmetric, expected a symmetric matrix");
  EXPECT_NE(message([](BundleMotion& m) { m.information(0, 0) = -1.0; }), "nothing thrown");
  EXPECT_NE(message([](BundleMotion& m) { m.information(0, 0) = std::nan(""); }), "nothing thrown");
  EXPECT_NE(message([](BundleMotion& m) { m.to_from.linear() *= 2.0; }), "nothing thrown");
}

}  // namespace
}  // namespace hmcdyn::slam

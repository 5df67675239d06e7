// SPDX-License-Identifier: BSD-3-Clause
#include "two_view/camera_motion.hpp"

#include <cstdint>
#include <random>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace hmcdyn::internal {
namespace {

const PinholeCamera kCamera{500.0, 500.0, 320.0, 240.0};

Eigen::Isometry3d motionOf(const Eigen::Vector3d& turn, const Eigen::Vector3d& way) {
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  if (turn.norm() > 0.0) {
    motion.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  }
  motion.translation() = way;
  return motion;
}

/// Points of a room and, more of them, of a crowd that all walk the same way, seen without noise.
struct Street {
  std::vector<float> earlier_u, earlier_v, current_u, current_v, depth;

  void add(int points, const Eigen::Isometry3d& current_from_earlier, std::uint32_t seed) {
    std::mt19937 random(seed);
    const auto uniform = [&](double low, double high) {
      return low + (high - low) * static_cast<double>(random()) / 4294967295.0;
    };
    for (int i = 0; i < points; ++i) {
      const Eigen::Vector3d now =
          kCamera.unproject(uniform(20.0, 620.0), uniform(20.0, 460.0), uniform(1.0, 4.0));
      const Eigen::Vector2d current = kCamera.project(now);
      const Eigen::Vector2d earlier = kCamera.project(current_from_earlier.inverse() * now);
      current_u.push_back(static_cast<float>(current.x()));
      current_v.push_back(static_cast<float>(current.y()));
      earlier_u.push_back(static_cast<float>(earlier.x()));
      earlier_v.push_back(static_cast<float>(earlier.y()));
      depth.push_back(static_cast<float>(now.z()));
    }
  }
  PointPairsView pairs() const { return {earlier_u, earlier_v, current_u, current_v}; }
  std::vector<std::uint8_t> all() const { return std::vector<std::uint8_t>(depth.size(), 1); }
};

void expectNear(const Eigen::Isometry3d& motion, const Eigen::Isometry3d& truth) {
  EXPECT_LT((motion.translation() - truth.translation()).norm(), 1e-4);
  EXPECT_LT(
      Eigen::AngleAxisd(Eigen::Matrix3d(motion.linear() * truth.linear().transpose())).angle(),
      1e-4);
}

TEST(FitCameraMotion, MakesAPredictionExact) {
  const Eigen::Isometry3d truth = motionOf({0.004, -0.008, 0.002}, {0.01, -0.004, 0.012});
  Street street;
  street.add(100, truth, 1);
  const auto motion = fitCameraMotion(kCamera, street.pairs(), street.depth, street.all(),
                                      motionOf({0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}), 8.0f, {});
  ASSERT_TRUE(motion);
  expectNear(motion->current_from_earlier, truth);
  EXPECT_EQ(motion->points, 100U);
  EXPECT_EQ(motion->inliers, 100U);
}

// The crowd moves by 3 cm a frame, 4 to 15 px: three of four points say so.
TEST(FitCameraMotion, ACrowdIsNotTakenForTheWorldWhereThePredictionIsNearTheTruth) {
  const Eigen::Isometry3d truth = motionOf({0.0, 0.01, 0.0}, {0.01, 0.0, 0.0});
  const Eigen::Isometry3d crowd = truth * motionOf({0.0, 0.0, 0.0}, {0.03, 0.0, 0.0});
  Street street;
  street.add(100, truth, 2);
  street.add(300, crowd, 3);
  const Eigen::Isometry3d predicted = motionOf({0.0, 0.0125, 0.0}, {0.011, 0.0005, 0.0});
  const auto motion =
      fitCameraMotion(kCamera, street.pairs(), street.depth, street.all(), predicted, 2.0f, {});
  ASSERT_TRUE(motion);
  expectNear(motion->current_from_earlier, truth);
  EXPECT_LT(motion->inliers, 150U);
}

TEST(FitCameraMotion, WhoMayNotSpeakHasNoSay) {
  const Eigen::Isometry3d truth = motionOf({0.0, 0.01, 0.0}, {0.01, 0.0, 0.0});
  Street street;
  street.add(50, truth, 4);
  street.add(300, motionOf({0.0, 0.0, 0.0}, {0.0, 0.01, 0.0}), 5);
  std::vector<std::uint8_t> speaks(350, 0);
  std::fill(speaks.begin(), speaks.begin() + 50, 1);
  const auto motion = fitCameraMotion(kCamera, street.pairs(), street.depth, speaks,
                                      motionOf({0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}), 8.0f, {});
  ASSERT_TRUE(motion);
  expectNear(motion->current_from_earlier, truth);
  EXPECT_EQ(motion->points, 50U);
}

TEST(FitCameraMotion, TooFewPointsOrNoDepthIsNothing) {
  const Eigen::Isometry3d still = Eigen::Isometry3d::Identity();
  Street street;
  street.add(11, still, 6);  // one below TwoViewOptions::min_matches
  EXPECT_FALSE(
      fitCameraMotion(kCamera, street.pairs(), street.depth, street.all(), still, 8.0f, {}));
  street.add(100, still, 7);
  std::fill(street.depth.begin(), street.depth.end(), 0.0f);
  EXPECT_FALSE(
      fitCameraMotion(kCamera, street.pairs(), street.depth, street.all(), still, 8.0f, {}));
}

}  // namespace
}  // namespace hmcdyn::internal

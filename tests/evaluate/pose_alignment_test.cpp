// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/pose_alignment.hpp"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

namespace hmcdyn::evaluate {
namespace {

StampedPose poseAt(double timestamp, const Eigen::Vector3d& position, double angle) {
  StampedPose stamped;
  stamped.timestamp = timestamp;
  stamped.pose.linear() =
      Eigen::AngleAxisd(angle, Eigen::Vector3d(1, 2, 2) / 3.0).toRotationMatrix();
  stamped.pose.translation() = position;
  return stamped;
}

TEST(PoseAlignment, FindsTheRotationAboutAStraightPath) {
  const Eigen::Isometry3d truth_from_estimate =
      Eigen::Translation3d(1.0, -2.0, 0.5) *
      Eigen::AngleAxisd(2.5, Eigen::Vector3d(2.0, -1.0, 0.5).normalized());
  Trajectory truth;
  Trajectory estimate;
  for (int i = 0; i < 5; ++i) {
    StampedPose stamped = poseAt(i, {0.1 * i, 0.0, 0.0}, 0.2 * i);
    estimate.push_back(stamped);
    stamped.pose = truth_from_estimate * stamped.pose;
    truth.push_back(stamped);
  }
  const Alignment alignment = alignPoses(truth, estimate);
  const Eigen::Vector3d beside_the_path(0.3, 2.0, -1.0);
  EXPECT_LT((alignment * beside_the_path - truth_from_estimate * beside_the_path).norm(), 1e-12);
}

TEST(PoseAlignment, MeansOfTwoPosesByHand) {
  // Rotations about one axis by +0.1 and -0.1, positions (0, 0, 1) and (0, 0, 3) instead of 0.
  const Trajectory estimate{poseAt(0, {0, 0, 0}, 0.0), poseAt(1, {0, 0, 0}, 0.0)};
  const Trajectory truth{poseAt(0, {0, 0, 1}, 0.1), poseAt(1, {0, 0, 3}, -0.1)};
  const Alignment alignment = alignPoses(truth, estimate);
  EXPECT_LT((alignment.rotation - Eigen::Matrix3d::Identity()).norm(), 1e-12);
  EXPECT_LT((alignment.translation - Eigen::Vector3d(0, 0, 2)).norm(), 1e-12);
}

TEST(PoseAlignment, WithoutCommonTimesThereIsNone) {
  EXPECT_THROW(alignPoses({poseAt(0, {0, 0, 0}, 0)}, {poseAt(9, {0, 0, 0}, 0)}),
               std::runtime_error);
  EXPECT_THROW(alignPoses({}, {poseAt(9, {0, 0, 0}, 0)}), std::invalid_argument);
}

}  // namespace
}  // namespace hmcdyn::evaluate

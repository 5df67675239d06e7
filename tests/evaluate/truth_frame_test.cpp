// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/truth_frame.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "evaluate/absolute_trajectory_error.hpp"
#include "evaluate/relative_pose_error.hpp"

namespace hmcdyn::evaluate {
namespace {

/// A camera that turns about itself on a slow walk, at 10 Hz.
Trajectory turningCamera() {
  Trajectory camera;
  for (int i = 0; i < 100; ++i) {
    StampedPose stamped;
    stamped.timestamp = 0.1 * i;
    stamped.pose = Eigen::Translation3d(0.01 * i, 0.2 * std::sin(0.05 * i), 0.0) *
                   Eigen::AngleAxisd(0.03 * i, Eigen::Vector3d::UnitZ());
    camera.push_back(stamped);
  }
  return camera;
}

/// Poses of something that is mounted to the camera.
Trajectory mounted(Trajectory camera, const Eigen::Isometry3d& camera_from_thing) {
  for (StampedPose& stamped : camera) {
    stamped.pose = stamped.pose * camera_from_thing;
  }
  return camera;
}

TEST(TruthFrame, BonnsTransformsMakeARigidOne) {
  const Eigen::Isometry3d pose = bonnMarkersFromCamera();
  EXPECT_TRUE((pose.linear() * pose.linear().transpose()).isIdentity(1e-12));
  EXPECT_NEAR(pose.linear().determinant(), 1.0, 1e-12);
  // T_ros (0.0113, -0.0098, 0.0111), by hand
  EXPECT_TRUE(pose.translation().isApprox(Eigen::Vector3d(-0.0113, 0.0111, -0.0098), 1e-12));
  // Its first axis is T_ros times T_m's first column, but for the scale of 1.0593, to the four
  // digits of the page
  const Eigen::Vector3d axis = Eigen::Vector3d(-1.0157, -0.3009, 0.0009) / 1.0593;
  EXPECT_LT((pose.linear().col(0) - axis).norm(), 2e-4);
}

TEST(TruthFrame, OfTheCameraNothingChanges) {
  const Trajectory camera = turningCamera();
  const Trajectory same = ofCamera(camera, TruthFrame::kCamera);
  ASSERT_EQ(same.size(), camera.size());
  EXPECT_TRUE(same.back().pose.isApprox(camera.back().pose, 0.0));
}

TEST(TruthFrame, MarkersErrByTheirOffsetWhichTheOptionTakesAway) {
  // Given a perfect estimate of a camera, and a truth of the markers, in a world of theirs
  const Trajectory camera = turningCamera();
  Trajectory markers = mounted(camera, bonnMarkersFromCamera().inverse());
  const Eigen::Isometry3d world =
      Eigen::Translation3d(3.0, -1.0, 0.5) * Eigen::AngleAxisd(1.1, Eigen::Vector3d::UnitX());
  for (StampedPose& stamped : markers) {
    stamped.pose = world * stamped.pose;
  }
  // When, then: raw, ATE has a part of the offset of 18.6 mm, which alignment takes away in part;
  // with the option it is none
  const double raw = absoluteTrajectoryError(markers, camera).error.rmse;
  EXPECT_GT(raw, 0.005);
  EXPECT_LT(raw, 0.0187);
  const Trajectory truth = ofCamera(markers, TruthFrame::kBonnMarkers);
  EXPECT_LT(absoluteTrajectoryError(truth, camera).error.rmse, 1e-9);
  EXPECT_LT(relativePoseError(truth, camera).translation.rmse, 1e-9);
}

}  // namespace
}  // namespace hmcdyn::evaluate

// SPDX-License-Identifier: BSD-3-Clause
#include "synthesize/trajectory_file.hpp"

#include <fstream>
#include <stdexcept>

#include <gtest/gtest.h>

#include "shared_data.hpp"
#include "test_scenes.hpp"

namespace hmcdyn::synthesize {
namespace {

using Eigen::Vector3d;
using test::TemporaryFolder;

const RoomBounds kRoom(Vector3d(-4, -4, 0), Vector3d(4, 4, 3));

std::filesystem::path written(const TemporaryFolder& folder, const std::string& text) {
  const std::filesystem::path path = folder / "groundtruth.txt";
  std::ofstream(path) << text;
  return path;
}

std::string messageOf(const std::filesystem::path& path) {
  try {
    readTrajectory(path);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "no error";
}

TEST(TrajectoryFile, ReadsPosesAndSkipsComments) {
  const TemporaryFolder folder;
  const auto poses =
      readTrajectory(written(folder,
                             "# timestamp tx ty tz qx qy qz qw\n\n1.5 1 2 3 0 0 0 1\r\n"
                             "1.6 1 2 4 0 0 0.70710678 0.70710678\n"));
  ASSERT_EQ(poses.size(), 2U);
  EXPECT_DOUBLE_EQ(poses[0].time, 1.5);
  EXPECT_TRUE(poses[0].camera_to_world.translation().isApprox(Vector3d(1, 2, 3)));
  // A quarter turn about z takes x to y.
  EXPECT_TRUE(
      (poses[1].camera_to_world.linear() * Vector3d::UnitX()).isApprox(Vector3d::UnitY(), 1e-7));
}

TEST(TrajectoryFile, NamesFileAndLineOfWhatItCannotUse) {
  const TemporaryFolder folder;
  const std::string good = "1 0 0 0 0 0 0 1\n";
  EXPECT_NE(messageOf(folder / "missing.txt").find("missing.txt: cannot be read"),
            std::string::npos);
  EXPECT_NE(messageOf(written(folder, good + "2 0 0 0\n")).find("groundtruth.txt:2: 4 values"),
            std::string::npos);
  EXPECT_NE(messageOf(written(folder, good + "2 0 zero 0 0 0 0 1\n")).find(":2: 'zero'"),
            std::string::npos);
  EXPECT_NE(messageOf(written(folder, "1 nan 0 0 0 0 0 1\n")).find(":1: 'nan'"), std::string::npos);
  EXPECT_NE(messageOf(written(folder, good + "2 0 0 0 0 0 0 0\n")).find(":2: the quaternion"),
            std::string::npos);
  EXPECT_NE(messageOf(written(folder, "2 0 0 0 0 0 0 1\n" + good)).find(":2: the time stamp falls"),
            std::string::npos);
}

TEST(TrajectoryFile, RepeatedTimeStampKeepsTheFirstPose) {
  const TemporaryFolder folder;
  const auto poses = readTrajectory(
      written(folder, "1 0 0 0 0 0 0 1\n2 5 0 0 0 0 0 1\n2 6 0 0 0 0 0 1\n3 7 0 0 0 0 0 1\n"));
  ASSERT_EQ(poses.size(), 3U);
  EXPECT_EQ(poses[1].camera_to_world.translation().x(), 5.0);
}

/// A walk of 1 m along the recording's x in 2 s, looking along the recording's z.
std::string straightWalk() {
  std::string text;
  for (int i = 0; i <= 20; ++i) {
    text += std::to_string(100.0 + 0.1 * i) + " " + std::to_string(0.05 * i) + " 5 7 0 0 0 1\n";
  }
  return text;
}

TEST(TrajectoryFile, WholePathIsMovedRigidlyToTheScenesView) {
  const TemporaryFolder folder;
  const Eigen::Isometry3d view = lookAt(Vector3d(0, -2, 1.4), Vector3d(0, 1, 1.4));
  const CameraPath path = pathFromFile(written(folder, straightWalk()), view, 2.0, kRoom);
  // The middle of the walk is the view; the recording's x is the view's right, the world's x.
  EXPECT_TRUE(path(1.0).isApprox(view, 1e-6));
  EXPECT_TRUE(path(0.5).translation().isApprox(Vector3d(-0.25, -2, 1.4), 1e-6));
  EXPECT_TRUE(path(1.5).translation().isApprox(Vector3d(0.25, -2, 1.4), 1e-6));
}

TEST(TrajectoryFile, TooShortOrOutsideOfTheRoomIsAnError) {
  const TemporaryFolder folder;
  const Eigen::Isometry3d view = lookAt(Vector3d(0, -2, 1.4), Vector3d(0, 1, 1.4));
  const auto file = written(folder, straightWalk());
  EXPECT_THROW(pathFromFile(file, view, 2.5, kRoom), std::runtime_error);
  const RoomBounds closet(Vector3d(-0.4, -4, 0), Vector3d(0.4, 4, 3));
  EXPECT_THROW(pathFromFile(file, view, 2.0, closet), std::runtime_error);
}

TEST(TrajectoryFile, FollowsARealRecordingToMillimetres) {
  HMCDYN_SKIP_WITHOUT_SHARED("eval/groundtruth/fr3_walk_xyz.txt");
  const auto file = hmcdyn::test::sharedPath("eval/groundtruth/fr3_walk_xyz.txt");
  const Eigen::Isometry3d view = lookAt(Vector3d(0, -2.5, 1.45), Vector3d(0, 0.6, 0.95));
  const CameraPath path = pathFromFile(file, view, 20.0, kRoom);
  const auto recorded = readTrajectory(file);
  // Distances within the path are those of the recording, whatever the world.
  for (const std::size_t i : {100U, 500U, 900U, 1500U}) {
    const double time = recorded[i].time - recorded[0].time;
    const double expected =
        (recorded[i].camera_to_world.translation() - recorded[50].camera_to_world.translation())
            .norm();
    const double start = recorded[50].time - recorded[0].time;
    EXPECT_NEAR((path(time).translation() - path(start).translation()).norm(), expected, 0.004);
  }
}

}  // namespace
}  // namespace hmcdyn::synthesize

// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/trajectory.hpp"

#include <cmath>
#include <random>
#include <sstream>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "expect_throw.hpp"
#include "temporary_folder.hpp"
#include "trajectories.hpp"

namespace hmcdyn::evaluate {
namespace {

Trajectory parse(const std::string& text) {
  std::istringstream stream(text);
  return readTrajectory(stream, "poses.txt");
}

std::string parseError(const std::string& text) {
  return test::messageOf<std::runtime_error>([&] { parse(text); });
}

TEST(ReadTrajectory, ReadsPositionAndRotation) {
  // A quarter turn about z takes x to y.
  const Trajectory trajectory = parse("12.5 1 -2 3e-1 0 0 0.70710678118 0.70710678118\n");
  ASSERT_EQ(trajectory.size(), 1U);
  EXPECT_DOUBLE_EQ(trajectory[0].timestamp, 12.5);
  EXPECT_TRUE(trajectory[0].pose.translation().isApprox(Eigen::Vector3d(1.0, -2.0, 0.3)));
  EXPECT_TRUE((trajectory[0].pose.linear() * Eigen::Vector3d::UnitX())
                  .isApprox(Eigen::Vector3d::UnitY(), 1e-9));
}

TEST(ReadTrajectory, KeepsMicrosecondsOfUnixTime) {
  EXPECT_DOUBLE_EQ(parse("1341846434.710184 0 0 0 0 0 0 1")[0].timestamp, 1341846434.710184);
}

TEST(ReadTrajectory, ToleratesCommentsBlankLinesAndSeparators) {
  const Trajectory trajectory = parse(
      "# timestamp tx ty tz qx qy qz qw\n"
      "\n"
      "  1,2,3,4,0,0,0,1\n"
      "   \t\r\n"
      "  # in between\n"
      "2\t2\t3\t4\t0\t0\t0\t1\r\n"
      "3 , 2 , 3 , 4  0 0 0 1");
  ASSERT_EQ(trajectory.size(), 3U);
  for (const StampedPose& stamped : trajectory) {
    EXPECT_EQ(stamped.pose.translation(), Eigen::Vector3d(2.0, 3.0, 4.0));
  }
}

TEST(ReadTrajectory, NormalisesQuaternions) {
  const Eigen::Matrix3d rotation = parse("1 0 0 0 0 0 0.2 0.2")[0].pose.linear();
  EXPECT_TRUE((rotation * rotation.transpose()).isIdentity(1e-12));
  EXPECT_NEAR(rotation.determinant(), 1.0, 1e-12);
}

TEST(ReadTrajectory, OfDoubledStampsTakesTheLast) {
  const Trajectory trajectory = parse(
      "1 1 0 0 0 0 0 1\n"
      "1 2 0 0 0 0 0 1\n"
      "2 3 0 0 0 0 0 1\n");
  ASSERT_EQ(trajectory.size(), 2U);
  EXPECT_EQ(trajectory[0].pose.translation().x(), 2.0);
}

TEST(ReadTrajectory, NamesFileAndLineOfAMalformedPose) {
  const std::string good = "# comment\n1 0 0 0 0 0 0 1\n";
  EXPECT_EQ(
      parseError(good + "2 0 0 0 0 0 0\n"),
      "poses.txt:3: 7 fields; expected 8: timestamp tx ty tz qx qy qz qw; of seven numbers, is "
      "the time stamp missing, or is the rotation in angles?");
  EXPECT_EQ(
      parseError(good + "2 0 0 0 0 0 0 1 5\n"),
      "poses.txt:3: 9 fields; expected 8: timestamp tx ty tz qx qy qz qw; of nine numbers, is "
      "one a frame number? Leave it out");
  EXPECT_EQ(parseError(good + "\n2 0 zero 0 0 0 0 1\n"),
            "poses.txt:4: ty is 'zero'; expected a number");
  EXPECT_EQ(parseError(good + "2 0 0 1.5m 0 0 0 1\n"),
            "poses.txt:3: tz is '1.5m'; expected a number");
  EXPECT_EQ(parseError(good + "2 0 0 0 1e999 0 0 1\n"),
            "poses.txt:3: qx is '1e999'; expected a number");
}

TEST(ReadTrajectory, LeavesOutALineThatSaysThatThereWasNoPose) {
  for (const char* line : {"1.5 0 nan 0 0 0 0 1\n", "1.5 0 0 0 0 0 0 -inf\n", "nan 0 0 0 0 0 0 1\n",
                           "1.5 0 0 0 0 0 0 0\n"}) {
    EXPECT_EQ(parse("1 0 0 0 0 0 0 1\n" + std::string(line) + "2 0 0 0 0 0 0 1\n").size(), 2U);
    EXPECT_EQ(parseError(line),
              "poses.txt: holds no pose; expected lines `timestamp tx ty tz qx qy qz qw`, found 1 "
              "with NaN, infinity or a zero quaternion");
  }
}

TEST(ReadTrajectory, NamesFileAndLineWhereTimeGoesBack) {
  EXPECT_EQ(parseError("2 0 0 0 0 0 0 1\n1.5 0 0 0 0 0 0 1\n"),
            "poses.txt:2: timestamp 1.500000 is before the previous one, 2.000000; expected time "
            "to increase");
}

TEST(ReadTrajectory, RefusesAFileWithoutAPose) {
  EXPECT_EQ(parseError(""),
            "poses.txt: holds no pose; expected lines `timestamp tx ty tz qx qy qz qw`");
  EXPECT_THROW(parse("# only a comment\n"), std::runtime_error);
}

class TrajectoryFile : public test::TemporaryFolder {};

TEST_F(TrajectoryFile, ThatIsMissingOrAFolderIsNamed) {
  const std::string missing = path("missing.txt").string();
  EXPECT_EQ(test::messageOf<std::runtime_error>([&] { readTrajectory(missing); }),
            missing + ": cannot be read: No such file or directory");
  const std::string folder = path("").string();
  EXPECT_EQ(test::messageOf<std::runtime_error>([&] { readTrajectory(folder); }),
            folder + ": is a folder; expected a file");
}

TEST_F(TrajectoryFile, IsReadAsItWasWritten) {
  std::mt19937 random(3);
  Trajectory written;
  for (int i = 0; i < 20; ++i) {
    StampedPose stamped;
    stamped.timestamp = 1341846434.710184 + i;
    stamped.pose = test::randomPose(random, 10.0);
    written.push_back(stamped);
  }
  writeTrajectory(path("trajectory.txt"), written);
  const Trajectory read = readTrajectory(path("trajectory.txt"));
  ASSERT_EQ(read.size(), written.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_NEAR(read[i].timestamp, written[i].timestamp, 5e-7);
    EXPECT_TRUE(read[i].pose.isApprox(written[i].pose, 1e-8));
  }
}

TEST_F(TrajectoryFile, ThatCannotBeWrittenIsNamed) {
  const std::string nowhere = path("missing/trajectory.txt").string();
  EXPECT_EQ(test::messageOf<std::runtime_error>(
                [&] { writeTrajectory(nowhere, test::straightLine(3, 1.0)); }),
            nowhere + ": cannot be written: No such file or directory");
}

TEST_F(TrajectoryFile, OnAFullDiskIsNamed) {
  if (!std::filesystem::exists("/dev/full")) {
    GTEST_SKIP() << "needs /dev/full, which behaves as a full disk";
  }
  EXPECT_EQ(test::messageOf<std::runtime_error>(
                [] { writeTrajectory("/dev/full", test::straightLine(3, 1.0)); }),
            "/dev/full: cannot be written: No space left on device");
}

TEST_F(TrajectoryFile, OfTimestampsIsReadInItsOrder) {
  const auto file = write("rgb.txt", "# rgb\n3.5 rgb/3.5.png\n\n1.25\trgb/1.25.png extra\n");
  EXPECT_THAT(readTimestamps(file), testing::ElementsAre(3.5, 1.25));
}

TEST_F(TrajectoryFile, OfTimestampsNamesTheLineOfAnError) {
  const auto file = write("rgb.txt", "1.0 rgb/1.png\nrgb/2.png 2.0\n");
  EXPECT_EQ(test::messageOf<std::runtime_error>([&] { readTimestamps(file); }),
            file.string() + ":2: timestamp is 'rgb/2.png'; expected a number");
  const auto empty = write("empty.txt", "# nothing\n");
  EXPECT_EQ(test::messageOf<std::runtime_error>([&] { readTimestamps(empty); }),
            empty.string() + ": holds no line; expected lines that start with a timestamp");
}

TEST(ToTumLine, HoldsMicrosecondsAndNanometres) {
  EXPECT_EQ(toTumLine(test::stampedPose(1341846434.710184, {1.0, -0.25, 1e-9})),
            "1341846434.710184 1.000000000 -0.250000000 0.000000001 0.000000000 0.000000000 "
            "0.000000000 1.000000000");
}

}  // namespace
}  // namespace hmcdyn::evaluate

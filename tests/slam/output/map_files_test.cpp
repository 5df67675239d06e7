// SPDX-License-Identifier: BSD-3-Clause
#include "slam/output/map_files.hpp"

#include <csignal>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <unistd.h>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include "file_content.hpp"
#include "slam/input/dataset/temporary_folder.hpp"

namespace hmcdyn::slam {
namespace {

namespace fs = std::filesystem;
using test::contentOf;
using test::mentions;
using test::messageOf;
using test::TemporaryFolder;

/// A camera at (x, 0, 0) that looks along z.
StampedPose keyFrameAt(double timestamp, double x) {
  StampedPose key_frame{timestamp, Eigen::Isometry3d::Identity()};
  key_frame.camera_from_world.translation().x() = -x;
  return key_frame;
}

std::string lineAt(const char* stamp, const char* x) {
  return std::string(stamp) + " " + x +
         " 0.000000000 0.000000000 0.000000000 0.000000000 0.000000000 1.000000000\n";
}

TEST(KeyFrames, AreInTheFileAsSoonAsTheyAreWritten) {
  const TemporaryFolder folder;
  KeyFramesWriter writer(folder.path() / "keyframes.txt");
  writer.write(keyFrameAt(1.0, 0.5));
  EXPECT_EQ(contentOf(folder.path() / "keyframes.txt"), lineAt("1.000000", "0.500000000"));
}

TEST(KeyFrames, CorrectedPosesReplaceTheOldOnesAndLaterOnesFollow) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "keyframes.txt";
  KeyFramesWriter writer(file);
  writer.write(keyFrameAt(1.0, 0.5));
  writer.write(keyFrameAt(2.0, 1.5));
  std::ifstream reader(file);  // opened before the correction: keeps the old poses
  writer.rewrite({keyFrameAt(1.0, 0.25), keyFrameAt(2.0, 1.25)});
  writer.write(keyFrameAt(3.0, 2.0));
  EXPECT_EQ(contentOf(file), lineAt("1.000000", "0.250000000") + lineAt("2.000000", "1.250000000") +
                                 lineAt("3.000000", "2.000000000"));
  const std::string old{std::istreambuf_iterator<char>(reader), std::istreambuf_iterator<char>()};
  EXPECT_EQ(old, lineAt("1.000000", "0.500000000") + lineAt("2.000000", "1.500000000"));
  EXPECT_FALSE(fs::exists(folder.path() / "keyframes.txt.tmp"));
}

TEST(KeyFrames, ACorrectionThatCannotBeWrittenLeavesTheFileInUse) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "keyframes.txt";
  KeyFramesWriter writer(file);
  writer.write(keyFrameAt(1.0, 0.5));
  StampedPose broken = keyFrameAt(1.0, 0.5);
  broken.timestamp = std::numeric_limits<double>::infinity();
  EXPECT_THROW(writer.rewrite({broken}), std::invalid_argument);
  fs::create_directories(folder.path() / "keyframes.txt.tmp" / "in the way");
  EXPECT_TRUE(
      mentions(messageOf<std::runtime_error>([&] { writer.rewrite({keyFrameAt(1.0, 0.0)}); }),
               {"keyframes.txt: cannot be replaced", "keyframes.txt.tmp", "Is a directory"}));
  writer.write(keyFrameAt(2.0, 1.5));
  EXPECT_EQ(contentOf(file), lineAt("1.000000", "0.500000000") + lineAt("2.000000", "1.500000000"));
}

TEST(Loops, HaveARowACandidate) {
  const TemporaryFolder folder;
  LoopsWriter writer(folder.path() / "loops.csv");
  writer.write({20.5, 1.25, 0.75, 60, ""});
  writer.write({21.0, 2.0, std::numeric_limits<double>::quiet_NaN(), 3, "too few inliers"});
  writer.write({22.0, 2.0, 0.5, 0, "3 inliers, \"20\" expected"});
  EXPECT_EQ(contentOf(folder.path() / "loops.csv"),
            "timestamp,matched_timestamp,score,inliers,verdict\n"
            "20.500000,1.250000,0.75,60,accepted\n"
            "21.000000,2.000000,nan,3,too few inliers\n"
            "22.000000,2.000000,0.5,0,\"3 inliers, \"\"20\"\" expected\"\n");
}

TEST(Loops, AFullDiskIsNamed) {
  if (!fs::exists("/dev/full")) {
    GTEST_SKIP() << "needs /dev/full";
  }
  EXPECT_TRUE(mentions(messageOf<std::runtime_error>([] { LoopsWriter("/dev/full"); }),
                       {"/dev/full", "No space left on device"}));
}

/// The floats and colours of a PLY body, 15 bytes a vertex, on a little-endian machine.
float coordinateOf(const std::string& body, std::size_t vertex, std::size_t axis) {
  float value = 0.0f;
  std::memcpy(&value, body.data() + 15 * vertex + 4 * axis, sizeof value);
  return value;
}

TEST(Ply, HoldsPointsAndColoursByteForByte) {
  const TemporaryFolder folder;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  PointCloud cloud;
  cloud.position = {{1.0f, -2.5f, 3.0f}, {nan, 0.0f, 0.0f}, {0.1f, 0.2f, 0.3f}};
  cloud.colour = {{255, 0, 7}, {1, 1, 1}, {10, 20, 30}};
  EXPECT_EQ(writePly(folder.path() / "map.ply", cloud), 2U) << "NaN is left out";
  const std::string content = contentOf(folder.path() / "map.ply");
  const std::string end = "end_header\n";
  const std::string header = content.substr(0, content.find(end) + end.size());
  EXPECT_EQ(header,
            "ply\nformat binary_little_endian 1.0\ncomment hmcdyn, metres\nelement vertex 2\n"
            "property float x\nproperty float y\nproperty float z\n"
            "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n");
  const std::string body = content.substr(header.size());
  ASSERT_EQ(body.size(), 2U * 15U);
  EXPECT_EQ(body.substr(0, 4), std::string("\x00\x00\x80\x3f", 4)) << "1.0f, low byte first";
  EXPECT_EQ(coordinateOf(body, 0, 1), -2.5f);
  EXPECT_EQ(coordinateOf(body, 1, 0), 0.1f);
  EXPECT_EQ(coordinateOf(body, 1, 2), 0.3f);
  EXPECT_EQ(body.substr(12, 3), std::string("\xff\x00\x07", 3));
  EXPECT_EQ(body.substr(27, 3), std::string("\x0a\x14\x1e", 3));
}

TEST(Ply, LargeAndEmptyCloudsAreWhole) {
  const TemporaryFolder folder;
  PointCloud cloud;
  cloud.position.assign(200000, Eigen::Vector3f(1.0f, 2.0f, 3.0f));  // several chunks
  EXPECT_EQ(writePly(folder.path() / "map.ply", cloud), 200000U);
  const std::string content = contentOf(folder.path() / "map.ply");
  EXPECT_EQ(content.size() - content.find("end_header\n") - 11, 200000U * 15U);
  EXPECT_EQ(writePly(folder.path() / "map.ply", {}), 0U);
  EXPECT_NE(contentOf(folder.path() / "map.ply").find("element vertex 0\n"), std::string::npos);
}

TEST(Ply, UnequalSizesAreRefused) {
  PointCloud cloud;
  cloud.position.resize(2, Eigen::Vector3f::Zero());
  cloud.colour.resize(1);
  EXPECT_EQ(messageOf<std::invalid_argument>([&] { writePly("unused.ply", cloud); }),
            "point cloud: 2 points, 1 colours; expected none or one a point");
}

TEST(Ply, ADiskThatFillsLeavesTheOldFile) {
  const TemporaryFolder folder;
  const fs::path file = folder.write("map.ply", "old");
  const pid_t child = fork();  // the limit on the file size is the process's
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{1000, 1000};
    setrlimit(RLIMIT_FSIZE, &limit);
    PointCloud cloud;
    cloud.position.assign(1000, Eigen::Vector3f::Zero());
    try {
      writePly(file, cloud);
    } catch (const std::runtime_error&) {
      _exit(42);
    }
    _exit(0);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 42);
  EXPECT_EQ(contentOf(file), "old");
  EXPECT_FALSE(fs::exists(folder.path() / "map.ply.tmp"));
}

}  // namespace
}  // namespace hmcdyn::slam

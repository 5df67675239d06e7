// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/point_cloud_file.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

#include "evaluate/temporary_folder.hpp"

namespace hmcdyn::evaluate {
namespace {

using Positions = std::vector<Eigen::Vector3f>;

class PlyFile : public test::TemporaryFolder {
 protected:
  std::string messageFor(const std::string& content) const {
    try {
      readPlyPositions(write("map.ply", content));
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "no exception";
  }
};

TEST_F(PlyFile, BinaryWithOtherPropertiesBetween) {
  const std::string header =
      "ply\nformat binary_little_endian 1.0\ncomment made by hand\nelement vertex 2\n"
      "property uchar red\nproperty float x\nproperty double y\nproperty float z\nend_header\n";
  // 1, 2, 3 and NaN, 0, 0 (IEEE 754, low byte first).
  const std::string one("\x07\x00\x00\x80\x3f\x00\x00\x00\x00\x00\x00\x00\x40\x00\x00\x40\x40", 17);
  const std::string nan("\x07\x00\x00\xc0\x7f\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00", 17);
  EXPECT_EQ(readPlyPositions(write("map.ply", header + one + nan)),
            (Positions{{1.0f, 2.0f, 3.0f}}));
}

TEST_F(PlyFile, AsciiWithFacesBehind) {
  EXPECT_EQ(readPlyPositions(write("map.ply",
                                   "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\n"
                                   "property float y\nproperty float z\nelement face 1\n"
                                   "property list uchar int vertex_indices\nend_header\n"
                                   "1 2 3\n-0.5 nan 1\n3 0 0 0\n")),
            (Positions{{1.0f, 2.0f, 3.0f}}))
      << "NaN is left out";
}

TEST_F(PlyFile, NamesWhatIsWrong) {
  const std::string xyz = "property float x\nproperty float y\nproperty float z\nend_header\n";
  EXPECT_NE(messageFor("").find("map.ply: is no PLY file"), std::string::npos);
  EXPECT_NE(messageFor("ply\nformat ascii 1.0\n").find("header has no end"), std::string::npos);
  EXPECT_NE(messageFor("ply\nformat binary_big_endian 1.0\n").find("binary_big_endian"),
            std::string::npos);
  EXPECT_NE(messageFor("ply\nformat ascii 1.0\nelement face 3\n").find("first element is 'face'"),
            std::string::npos);
  EXPECT_NE(messageFor("ply\nformat ascii 1.0\nelement vertex 1\nproperty int x\nend_header\n1\n")
                .find("no float or double 'x'"),
            std::string::npos);
  EXPECT_NE(messageFor("ply\nformat ascii 1.0\nelement vertex 3\n" + xyz + "1 2 3\n4 5")
                .find("cut off or malformed after 1 of 3 vertices"),
            std::string::npos);
  EXPECT_NE(messageFor("ply\nformat ascii 1.0\nelement vertex 1\n" + xyz + "1 2 three\n")
                .find("malformed after 0 of 1 vertices"),
            std::string::npos);
  EXPECT_NE(messageFor("ply\nelement vertex 1\n" + xyz + "1 2 3\n").find("names no format"),
            std::string::npos);
  EXPECT_THROW(readPlyPositions(path("nowhere.ply")), std::runtime_error);
}

}  // namespace
}  // namespace hmcdyn::evaluate

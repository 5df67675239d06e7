// SPDX-License-Identifier: BSD-3-Clause
#include <cstdlib>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sys/wait.h>

#include "evaluate/temporary_folder.hpp"

namespace hmcdyn::evaluate {
namespace {

/// A wall 2 m in front of a camera that moves along a bend; a map with a point on it and one in the
/// air.
class MapScoreBinary : public test::TemporaryFolder {
 protected:
  void SetUp() override {
    write("calibration.yaml", "fx: 64\nfy: 64\ncx: 31.5\ncy: 23.5\ndepth_factor: 5000\n");
    std::filesystem::create_directories(path("depth"));
    std::filesystem::create_directories(path("mask"));
    std::string poses, list;
    for (const char* i : {"1", "2", "3", "4"}) {
      const std::string stamp = std::string(i) + ".000000";
      poses += stamp + " 0." + i + (*i == '2' ? " 0.1" : " 0") + " 0 0 0 0 1\n";
      list += stamp + " rgb/" + i + ".png " + stamp + " depth/" + i + ".png\n";
      const std::string image = std::string(i) + ".png";
      cv::imwrite(path("depth/" + image).string(), cv::Mat(48, 64, CV_16UC1, cv::Scalar(10000)));
      cv::imwrite(path("mask/" + image).string(), cv::Mat(48, 64, CV_8UC1, cv::Scalar(0)));
    }
    write("groundtruth.txt", poses);
    write("associations.txt", list);
    write("map.ply",
          "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
          "property float z\nend_header\n0.1 0 2\n0.1 0 1\n");
  }

  int run(const std::string& arguments) const {
    const std::string command = std::string("'") + HMCDYN_MAP_SCORE + "' " + arguments + " >'" +
                                path("out").string() + "' 2>'" + path("err").string() + "'";
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  std::string files() const {
    return "'" + path("").string() + "' '" + path("map.ply").string() + "'";
  }
};

TEST_F(MapScoreBinary, PrintsJson) {
  ASSERT_EQ(run(files() + " --json"), 0) << read(path("err"));
  const nlohmann::json score = nlohmann::json::parse(read(path("out")));
  EXPECT_EQ(score["ghost_share"], 0.5);
  EXPECT_EQ(score["points"]["floating"], 1);
  ASSERT_EQ(run(files()), 0);
  EXPECT_EQ(read(path("out")).substr(0, 13), "0.5000 ghosts");
}

TEST_F(MapScoreBinary, AlignsTheMapByItsTrajectory) {
  // The run's world is the truth's, shifted by 5 m along z: so is its map.
  std::string trajectory;
  for (const char* i : {"1", "2", "3", "4"}) {
    trajectory += std::string(i) + ".000000 0." + i + (*i == '2' ? " 0.1" : " 0") + " 5 0 0 0 1\n";
  }
  write("trajectory.txt", trajectory);
  write("map.ply",
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
        "property float z\nend_header\n0.2 0 7\n");
  ASSERT_EQ(run(files() + " --json --trajectory '" + path("trajectory.txt").string() + "'"), 0)
      << read(path("err"));
  const nlohmann::json score = nlohmann::json::parse(read(path("out")));
  EXPECT_EQ(score["points"]["on_surface"], 1) << score.dump();
}

TEST_F(MapScoreBinary, ExitCodesTellUsageFromData) {
  EXPECT_EQ(run("--help"), 0);
  EXPECT_NE(read(path("out")).find("no static surface"), std::string::npos);
  EXPECT_EQ(run(""), 2);
  EXPECT_EQ(run(files() + " --every 0"), 2);
  EXPECT_EQ(run("'" + path("").string() + "' '" + path("none.ply").string() + "'"), 1);
  EXPECT_NE(read(path("err")).find("none.ply: cannot be read"), std::string::npos);
}

}  // namespace
}  // namespace hmcdyn::evaluate

// SPDX-License-Identifier: BSD-3-Clause
// A camera at rest before a wall at 2 m; a board of 0.5 x 0.5 m comes at 1 m in the last frames.
#include "octomap/occupancy.hpp"

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "evaluate/temporary_folder.hpp"

namespace hmcdyn::occupancy {
namespace {

class Occupancy : public evaluate::test::TemporaryFolder {
 protected:
  Occupancy() {
    const std::filesystem::path root = path("scene");
    for (const char* name : {"rgb", "depth", "mask"}) {
      std::filesystem::create_directories(root / name);
    }
    std::ofstream(root / "calibration.yaml")
        << "fx: 100\nfy: 100\ncx: 79.5\ncy: 59.5\nwidth: 160\nheight: 120\ndepth_factor: 5000\n";
    std::ofstream rgb(root / "rgb.txt");
    std::ofstream depth(root / "depth.txt");
    std::ofstream poses(root / "groundtruth.txt");
    for (int k = 0; k < 6; ++k) {
      const std::string stamp = fmt::format("{:.6f}", 10.0 + 0.1 * k);
      cv::Mat range(120, 160, CV_16U, cv::Scalar(10000));
      cv::Mat mask(120, 160, CV_8U, cv::Scalar(0));
      if (k >= 4) {
        const cv::Rect board(55, 35, 50, 50);
        range(board).setTo(5000);
        mask(board).setTo(255);
      }
      const std::string file = stamp + ".png";
      cv::imwrite((root / "rgb" / file).string(), cv::Mat(120, 160, CV_8UC3, cv::Scalar::all(90)));
      cv::imwrite((root / "depth" / file).string(), range);
      cv::imwrite((root / "mask" / file).string(), mask);
      rgb << stamp << " rgb/" << file << '\n';
      depth << stamp << " depth/" << file << '\n';
      poses << stamp << " 0 0 0 0 0 0 1\n";
    }
    options_.dataset = root;
    options_.camera = (root / "calibration.yaml").string();
    options_.trajectory = root / "groundtruth.txt";
    options_.resolution = 0.1;
    options_.pixel_step = 2;
    truth_ = options_;
    truth_.masks = root / "mask";
  }

  OccupancyOptions options_;
  OccupancyOptions truth_;
};

TEST_F(Occupancy, WhoComesLastIsAGhostWithoutMasksAndNotInTheMapWithThem) {
  const auto without = buildMap(options_);
  EXPECT_NE(without->search(0.0, 0.0, 1.0), nullptr);
  const GhostCount ghosts = countGhosts(*without, truth_);
  // 0.5 x 0.5 m of voxels of 0.1 m, those at the rim in part
  EXPECT_GE(ghosts.ghosts, 25U);
  EXPECT_LE(ghosts.ghosts, 36U);

  OccupancyOptions masked = options_;
  masked.masks = truth_.masks;
  const auto with = buildMap(masked);
  const GhostCount none = countGhosts(*with, truth_);
  EXPECT_EQ(none.ghosts, 0U);
  EXPECT_EQ(none.occupied, ghosts.occupied - ghosts.ghosts) << "the wall is there as before";
}

TEST_F(Occupancy, AFrameWithoutAMaskIsLeftOut) {
  OccupancyOptions masked = options_;
  masked.masks = truth_.masks;
  std::filesystem::remove(truth_.masks / "10.500000.png");
  std::filesystem::remove(truth_.masks / "10.400000.png");
  EXPECT_EQ(countGhosts(*buildMap(masked), truth_).ghosts, 0U);
}

TEST_F(Occupancy, WhatCannotBeIsRefused) {
  OccupancyOptions options = options_;
  options.resolution = 0.0;
  EXPECT_THROW(buildMap(options), std::invalid_argument);
  options = options_;
  options.pixel_step = 0;
  EXPECT_THROW(buildMap(options), std::invalid_argument);
  options = options_;
  options.max_depth = -1.0f;
  EXPECT_THROW(buildMap(options), std::invalid_argument);
  EXPECT_THROW(countGhosts(octomap::OcTree(0.1), options_), std::invalid_argument);
}

}  // namespace
}  // namespace hmcdyn::occupancy

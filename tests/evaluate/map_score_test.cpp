// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/map_score.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "evaluate/temporary_folder.hpp"

namespace hmcdyn::evaluate {
namespace {

const PinholeCamera kCamera{64.0, 64.0, 31.5, 23.5};

/// A camera at (x, 0, 0) that looks along z at a wall 2 m away, 64 x 48 pixels.
TrueFrame wallFrom(double x) {
  TrueFrame frame;
  frame.depth = cv::Mat(48, 64, CV_32FC1, cv::Scalar(2.0f));
  frame.mask = cv::Mat(48, 64, CV_8UC1, cv::Scalar(0));
  frame.camera_from_world.translation().x() = -x;
  return frame;
}

MapScore scoreOf(const std::vector<Eigen::Vector3f>& points, const std::vector<TrueFrame>& frames) {
  MapScorer scorer(points, kCamera);
  for (const TrueFrame& frame : frames) {
    scorer.add(frame);
  }
  return scorer.score();
}

TEST(MapScoring, CountsEveryKindOfPointOnce) {
  // The tolerance at 2 m is 0.04 + 0.008 * 4 = 0.072 m.
  const MapScore score = scoreOf({{0.0f, 0.0f, 2.0f},
                                  {0.0f, 0.0f, 2.07f},
                                  {0.0f, 0.0f, 1.93f},
                                  {0.0f, 0.0f, 1.0f},   // in the air
                                  {0.0f, 0.0f, 1.92f},  // just so
                                  {0.0f, 0.0f, 2.5f},   // in the wall
                                  {0.0f, 0.0f, -1.0f},  // behind the camera
                                  {9.0f, 0.0f, 2.0f}},  // beside the image
                                 {wallFrom(0.0)});
  EXPECT_EQ(score.on_surface, 3U);
  EXPECT_EQ(score.floating, 2U);
  EXPECT_EQ(score.buried, 1U);
  EXPECT_EQ(score.unseen, 2U);
  EXPECT_DOUBLE_EQ(score.ghostShare(), 0.5);
}

TEST(MapScoring, OneFrameThatSeesTheSurfaceIsEnough) {
  // A table top's edge 1 m away hides the point's wall from the first camera; the second looks
  // past.
  TrueFrame hidden = wallFrom(0.0);
  hidden.depth.setTo(1.0f);
  const MapScore score = scoreOf({{0.0f, 0.0f, 2.0f}}, {hidden, wallFrom(0.5)});
  EXPECT_EQ(score.on_surface, 1U);
}

TEST(MapScoring, PeopleAreNoSurfaceAndHideWhatIsBehind) {
  TrueFrame frame = wallFrom(0.0);
  frame.depth.setTo(1.5f);
  frame.mask.setTo(128);
  const MapScore score =
      scoreOf({{0.0f, 0.0f, 1.5f}, {0.0f, 0.0f, 2.0f}, {0.0f, 0.0f, 1.0f}}, {frame});
  EXPECT_EQ(score.on_surface, 0U);
  EXPECT_EQ(score.unseen, 2U) << "on the person, or behind: the frame does not tell";
  EXPECT_EQ(score.floating, 1U) << "in front of the person is air";
  const MapScore later = scoreOf({{0.0f, 0.0f, 1.5f}}, {frame, wallFrom(0.0)});
  EXPECT_EQ(later.floating, 1U) << "when the person is gone";
}

TEST(MapScoring, HalfAPixelAtASilhouetteDoesNotMakeAGhost) {
  TrueFrame frame = wallFrom(0.0);
  frame.depth.colRange(0, 32) = 1.0f;  // a board to the left of column 32
  // On the board, but projected to column 32: 1 * 0.5 / 64 m to the right of the axis.
  const MapScore score = scoreOf({{0.0079f, 0.0f, 1.0f}, {0.05f, 0.0f, 1.0f}}, {frame});
  EXPECT_EQ(score.on_surface, 1U);
  EXPECT_EQ(score.floating, 1U) << "three pixels from it is air";
}

TEST(MapScoring, PixelsWithoutDepthSayNothing) {
  TrueFrame frame = wallFrom(0.0);
  frame.depth.setTo(0.0f);
  EXPECT_EQ(scoreOf({{0.0f, 0.0f, 1.0f}}, {frame}).unseen, 1U);
}

TEST(MapScoring, CoverageIsTheShareOfSamplesWithAPointNearby) {
  // Samples at columns 8, 24, 40, 56 and rows 8, 24, 40; points at the places of two of them.
  const Eigen::Vector3f a = kCamera.unproject(8, 8, 2.0).cast<float>();
  const Eigen::Vector3f b =
      kCamera.unproject(40, 24, 2.0).cast<float>() + Eigen::Vector3f(0.04f, 0, 0);
  const Eigen::Vector3f c =
      kCamera.unproject(56, 40, 2.0).cast<float>() + Eigen::Vector3f(0.06f, 0, 0);
  const MapScore score = scoreOf({a, b, c}, {wallFrom(0.0)});
  EXPECT_EQ(score.surface, 12U);
  EXPECT_EQ(score.covered, 2U) << "the third is farther than 5 cm";
  EXPECT_DOUBLE_EQ(score.coverage(), 2.0 / 12.0);
}

TEST(MapScoring, AnEmptyMapHasNoShareAndCoversNothing) {
  const MapScore score = scoreOf({}, {wallFrom(0.0)});
  EXPECT_TRUE(std::isnan(score.ghostShare()));
  EXPECT_EQ(score.coverage(), 0.0);
  EXPECT_TRUE(std::isnan(MapScore().coverage()));
}

TEST(MapScoring, RefusesWhatDoesNotFit) {
  EXPECT_THROW(MapScorer({{std::numeric_limits<float>::quiet_NaN(), 0.0f, 0.0f}}, kCamera),
               std::invalid_argument);
  MapScoreOptions options;
  options.every = 0;
  EXPECT_THROW(MapScorer({}, kCamera, options), std::invalid_argument);
  TrueFrame frame = wallFrom(0.0);
  frame.mask = cv::Mat(4, 4, CV_8UC1);
  MapScorer scorer({}, kCamera);
  EXPECT_THROW(scorer.add(frame), std::invalid_argument);
}

class MapScoringOfAFolder : public test::TemporaryFolder {
 protected:
  void SetUp() override {
    write("calibration.yaml", "fx: 64\nfy: 64\ncx: 31.5\ncy: 23.5\ndepth_factor: 5000\n");
    write("groundtruth.txt", "# poses\n1.000000 0.5 0 0 0 0 0 1\n2.000000 0.5 0 0 0 0 0 1\n");
    write("associations.txt",
          "1.000000 rgb/1.png 1.000000 depth/1.png\n2.000000 rgb/2.png 2.000000 depth/2.png\n");
    std::filesystem::create_directories(path("depth"));
    std::filesystem::create_directories(path("mask"));
    cv::imwrite(path("depth/1.png").string(), cv::Mat(48, 64, CV_16UC1, cv::Scalar(10000)));
    cv::imwrite(path("mask/1.png").string(), cv::Mat(48, 64, CV_8UC1, cv::Scalar(0)));
  }
};

TEST_F(MapScoringOfAFolder, ReadsPosesDepthsAndMasks) {
  const MapScore score = scoreMap({{0.5f, 0.0f, 2.0f}, {0.5f, 0.0f, 1.0f}}, path(""));
  EXPECT_EQ(score.on_surface, 1U);
  EXPECT_EQ(score.floating, 1U);
}

TEST_F(MapScoringOfAFolder, NamesTheFileThatIsMissing) {
  const auto message = [&](const MapScoreOptions& options) -> std::string {
    try {
      scoreMap({}, path(""), options);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return {};
  };
  MapScoreOptions all;
  all.every = 1;
  EXPECT_NE(message(all).find("depth/2.png: is missing"), std::string::npos) << message(all);
  write("associations.txt", "1.000000 rgb/1.png\n");
  EXPECT_NE(message({}).find("associations.txt:1: expected"), std::string::npos) << message({});
  write("calibration.yaml", "fx: 64\n");
  EXPECT_NE(message({}).find("calibration.yaml: 'fy' is missing"), std::string::npos)
      << message({});
}

}  // namespace
}  // namespace hmcdyn::evaluate

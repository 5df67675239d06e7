// SPDX-License-Identifier: BSD-3-Clause
#include "slam/input/camera/depth_correction.hpp"

#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

#include "slam/input/camera/rectifier.hpp"
#include "slam/input/dataset/frame.hpp"

namespace hmcdyn::slam {
namespace {

/// 2 x 3 nodes over an image of 5 x 3 pixels: nodes lie at columns 0, 2, 4 and rows 0 and 2.
DepthCorrection smallGrid() {
  DepthCorrection correction;
  correction.scale = 1.01;
  correction.rows = 2;
  correction.columns = 3;
  correction.growth = {0.00, 0.02, 0.04, 0.10, 0.12, 0.14};
  return correction;
}

TEST(DepthCorrection, EachPixelIsScaledAndGrowsBilinearly) {
  const cv::Mat depth(3, 5, CV_32FC1, cv::Scalar(2.0));
  const cv::Mat corrected = correctDepth(depth, smallGrid());
  // z (scale + growth z): on a node, between two columns, in the middle of four nodes.
  EXPECT_NEAR(corrected.at<float>(0, 0), 2.02, 1e-6);
  EXPECT_NEAR(corrected.at<float>(2, 4), 2.0 * (1.01 + 0.28), 1e-6);
  EXPECT_NEAR(corrected.at<float>(0, 1), 2.0 * (1.01 + 0.01 * 2.0), 1e-6);
  EXPECT_NEAR(corrected.at<float>(1, 3), 2.0 * (1.01 + 0.08 * 2.0), 1e-6);
}

TEST(DepthCorrection, GrowthAtAPixelIsWhatTheImageGets) {
  const DepthCorrection correction = smallGrid();
  const cv::Mat depth(3, 5, CV_32FC1, cv::Scalar(1.5));
  const cv::Mat corrected = correctDepth(depth, correction);
  for (int v = 0; v < 3; ++v) {
    for (int u = 0; u < 5; ++u) {
      const double growth = growthAt(correction, u, v, {5, 3});
      EXPECT_NEAR(corrected.at<float>(v, u), 1.5 * (1.01 + growth * 1.5), 1e-6) << u << ", " << v;
    }
  }
}

TEST(DepthCorrection, NoDepthStaysNoDepthAndNothingTurnsNegative) {
  cv::Mat depth(3, 5, CV_32FC1, cv::Scalar(0.0));
  depth.at<float>(1, 1) = 5.0f;
  DepthCorrection correction = smallGrid();
  correction.growth.assign(6, -0.5);  // 5 (1.01 - 2.5) < 0
  const cv::Mat corrected = correctDepth(depth, correction);
  EXPECT_EQ(cv::countNonZero(corrected), 0);
}

TEST(DepthCorrection, ScaleAloneNeedsNoGrid) {
  DepthCorrection correction;
  correction.scale = 0.98;
  const cv::Mat corrected = correctDepth(cv::Mat(4, 4, CV_32FC1, cv::Scalar(3.0)), correction);
  EXPECT_NEAR(corrected.at<float>(3, 3), 2.94, 1e-6);
}

TEST(DepthCorrection, WithoutErrorTheImageIsTheSame) {
  const cv::Mat depth(4, 4, CV_32FC1, cv::Scalar(3.0));
  EXPECT_EQ(correctDepth(depth, {}).data, depth.data);
}

TEST(DepthCorrection, RefusesWhatIsNoCorrectionAndWhatIsNoDepth) {
  const cv::Mat depth(4, 4, CV_32FC1, cv::Scalar(3.0));
  DepthCorrection correction = smallGrid();
  correction.growth.pop_back();
  EXPECT_THROW(correctDepth(depth, correction), std::invalid_argument);
  correction = smallGrid();
  correction.rows = 1;
  correction.growth.resize(3);
  EXPECT_THROW(correctDepth(depth, correction), std::invalid_argument);
  correction = smallGrid();
  correction.scale = 0.0;
  EXPECT_THROW(correctDepth(depth, correction), std::invalid_argument);
  correction = smallGrid();
  correction.growth[2] = std::numeric_limits<double>::infinity();
  EXPECT_THROW(correctDepth(depth, correction), std::invalid_argument);
  EXPECT_THROW(correctDepth(cv::Mat(4, 4, CV_16UC1), smallGrid()), std::invalid_argument);
}

TEST(DepthCorrection, FramesAreCorrectedWhereTheyAreRectified) {
  // Given a calibration without distortion but with a correction, when a frame is rectified, then
  // its depth is corrected, and the frame that was given is not.
  CameraCalibration calibration;
  calibration.width = 4;
  calibration.height = 4;
  calibration.pinhole = {100.0, 100.0, 1.5, 1.5};
  calibration.depth_correction.scale = 1.1;
  RgbdFrame frame;
  frame.bgr = cv::Mat(4, 4, CV_8UC3, cv::Scalar(1, 2, 3));
  frame.gray = cv::Mat(4, 4, CV_8UC1, cv::Scalar(2));
  frame.depth = cv::Mat(4, 4, CV_32FC1, cv::Scalar(2.0));
  const RgbdFrame rectified = rectify(frame, Rectifier(calibration));
  EXPECT_NEAR(rectified.depth.at<float>(2, 2), 2.2, 1e-6);
  EXPECT_EQ(frame.depth.at<float>(2, 2), 2.0f);
  calibration.distortion[0] = 0.01;
  EXPECT_NEAR(rectify(frame, Rectifier(calibration)).depth.at<float>(2, 2), 2.2, 1e-6);
}

}  // namespace
}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#include "slam/run/feature_budget.hpp"

#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include <hmcdyn/frame_filter.hpp>

namespace hmcdyn::slam {
namespace {

TEST(CoveredShare, OverlappingBoxesCountOnce) {
  // Given 64 x 64 pixels, a raster of 8 x 8 cells: two boxes of 4 x 8 cells that share 2 x 8
  const std::vector<DetectionBox> boxes{{0.0f, 0.0f, 31.0f, 63.0f}, {16.0f, 0.0f, 47.0f, 63.0f}};
  EXPECT_DOUBLE_EQ(coveredShare(boxes, cv::Size(64, 64)), 6.0 / 8.0);
}

TEST(CoveredShare, IsNoneWithoutBoxesOrWithInvertedOnesAndAllWithALargeOne) {
  EXPECT_DOUBLE_EQ(coveredShare({}, cv::Size(64, 48)), 0.0);
  const std::vector<DetectionBox> inverted{{40.0f, 40.0f, 10.0f, 10.0f}};
  EXPECT_DOUBLE_EQ(coveredShare(inverted, cv::Size(64, 48)), 0.0);
  const std::vector<DetectionBox> large{{-100.0f, -100.0f, 1000.0f, 1000.0f}};
  EXPECT_DOUBLE_EQ(coveredShare(large, cv::Size(61, 47)), 1.0);
  EXPECT_DOUBLE_EQ(coveredShare(large, cv::Size()), 0.0);
}

TEST(FeatureBudget, LeavesAsManyOutsideTheBoxesAsThereWereWithoutBoxes) {
  EXPECT_EQ(featureBudget(1000, 0.0, 2.5), 1000);
  EXPECT_EQ(featureBudget(1000, 0.5, 2.5), 2000);  // half of 2000 lie outside
  EXPECT_EQ(featureBudget(1000, 0.9, 2.5), 2500);  // up to the factor
  EXPECT_EQ(featureBudget(1000, 1.0, 1.0), 1000);
}

/// A mask of 60 x 40 px whose first columns move.
MotionMask firstColumnsMove(int columns) {
  MotionMask mask;
  mask.label = cv::Mat::zeros(40, 60, CV_8U);
  mask.label.colRange(0, columns).setTo(static_cast<int>(MaskLabel::kMoving));
  mask.moving_share = static_cast<float>(columns) / 60.0f;
  return mask;
}

TEST(CornersOfRoom, AreEverywhereWhileLittleMoves) {
  EXPECT_TRUE(cornersOfRoom({}, firstColumnsMove(10)).empty());
  const cv::Mat corners(40, 60, CV_8U, cv::Scalar(1));
  EXPECT_EQ(cv::countNonZero(cornersOfRoom(corners, firstColumnsMove(10))), 60 * 40);
}

TEST(CornersOfRoom, AreNotOnWhatMovesButForItsRim) {
  // Given 30 columns that move: their last 6 may have moved on, the image's border has not
  EXPECT_EQ(cv::countNonZero(cornersOfRoom({}, firstColumnsMove(30))), (60 - 24) * 40);
}

TEST(CornersOfRoom, AreAmongThoseThatWereAllowed) {
  cv::Mat corners = cv::Mat::zeros(40, 60, CV_8U);
  corners.rowRange(0, 10).setTo(255);
  EXPECT_EQ(cv::countNonZero(cornersOfRoom(corners, firstColumnsMove(30))), (60 - 24) * 10);
}

TEST(CornersOfRoom, OfAMaskOfAnotherSizeAreAsTheyWere) {
  const cv::Mat corners(20, 30, CV_8U, cv::Scalar(1));
  EXPECT_EQ(cornersOfRoom(corners, firstColumnsMove(30)).size(), corners.size());
}

TEST(FeatureBudget, RefusesWhatCannotBe) {
  EXPECT_THROW(featureBudget(0, 0.0, 2.0), std::invalid_argument);
  EXPECT_THROW(featureBudget(1000, 0.0, 0.5), std::invalid_argument);
}

}  // namespace
}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#include "slam/output/dense/static_depth.hpp"

#include <limits>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace hmcdyn::slam {
namespace {

DetectionBox box(float x_min, float y_min, float x_max, float y_max, int class_id = 0) {
  return {x_min, y_min, x_max, y_max, class_id, 1.0f};
}

cv::Mat grey(int rows, int columns) { return {rows, columns, CV_8UC3, cv::Scalar(1, 2, 3)}; }

TEST(StaticMask, LeavesOutBoxesWithTheirMargin) {
  StaticDepthOptions options;
  options.box_margin = 2.0f;
  const std::vector<DetectionBox> boxes{box(10, 5, 12, 8)};
  const cv::Mat mask = staticMask({40, 20}, boxes, {}, options);
  // Columns 8 to 14, rows 3 to 10.
  EXPECT_EQ(40 * 20 - cv::countNonZero(mask), 7 * 8);
  EXPECT_EQ(mask.at<std::uint8_t>(3, 8), 0);
  EXPECT_EQ(mask.at<std::uint8_t>(10, 14), 0);
  EXPECT_EQ(mask.at<std::uint8_t>(2, 8), 255);
  EXPECT_EQ(mask.at<std::uint8_t>(10, 15), 255);
}

TEST(StaticMask, LeavesOutTheSurroundingsOfDynamicPoints) {
  StaticDepthOptions options;
  options.point_radius = 1.0f;
  const std::vector<cv::Point2f> points{{5.0f, 6.0f}, {0.0f, 0.0f}};
  const cv::Mat mask = staticMask({40, 20}, {}, points, options);
  EXPECT_EQ(40 * 20 - cv::countNonZero(mask), 9 + 4) << "the corner's surroundings are cut";
  EXPECT_EQ(mask.at<std::uint8_t>(7, 6), 0);
}

TEST(StaticMask, TakesWhatCoversNothing) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  const std::vector<DetectionBox> nothing{box(10, 5, 8, 9), box(nan, 0, 9, 9), box(0, 0, 9, nan),
                                          box(100, 100, 120, 120), box(-90, -90, -50, -50)};
  const std::vector<cv::Point2f> points{{nan, 1.0f}, {inf, inf}};
  EXPECT_EQ(cv::countNonZero(staticMask({40, 20}, nothing, points)), 40 * 20);
  const std::vector<DetectionBox> all{box(-inf, -inf, inf, inf)};
  EXPECT_EQ(cv::countNonZero(staticMask({40, 20}, all, {})), 0);
}

/// Nothing moves in 40 x 20 pixels.
cv::Mat stillMotion() { return cv::Mat::zeros(20, 40, CV_8UC1); }
cv::Mat depthOf(float metres) { return {20, 40, CV_32FC1, cv::Scalar(metres)}; }
int leftOut(const cv::Mat& mask) { return 40 * 20 - cv::countNonZero(mask); }

TEST(StaticMaskByMotion, LeavesOutWhatMovesOrMayMoveWithTheMarginAndDynamicPoints) {
  StaticDepthOptions options;
  options.box_margin = 1.0f;
  options.point_radius = 0.0f;
  cv::Mat motion = stillMotion();
  motion.at<std::uint8_t>(5, 30) = 255;
  motion.at<std::uint8_t>(10, 30) = 128;
  motion.row(0).setTo(64);
  const std::vector<cv::Point2f> points{{2.0f, 15.0f}};
  const cv::Mat mask = staticMaskByMotion(motion, depthOf(2.0f), {}, points, options);
  EXPECT_EQ(leftOut(mask), 9 + 9 + 1);  // 3 x 3 around each of the two, a point; not the unknown
  EXPECT_EQ(mask.at<std::uint8_t>(6, 31), 0) << "moves";
  EXPECT_EQ(mask.at<std::uint8_t>(9, 29), 0) << "stands but may move";
  EXPECT_EQ(mask.at<std::uint8_t>(15, 2), 0) << "a dynamic key point";
}

TEST(StaticMaskByMotion, KeepsInABoxOnlyWhatLiesWellBehindTheThing) {
  StaticDepthOptions options;
  options.box_margin = 0.0f;
  options.room_behind = 0.5f;
  const std::vector<DetectionBox> boxes{box(10, 5, 19, 14)};
  cv::Mat motion = stillMotion();
  motion(cv::Rect(10, 5, 5, 10)).setTo(128);  // the left half of the box: who stands, at 2 m
  cv::Mat depth = depthOf(4.0f);
  depth(cv::Rect(10, 5, 5, 10)).setTo(2.0f);
  depth(cv::Rect(15, 5, 5, 1)).setTo(2.4f);  // an arm that the mask missed
  depth(cv::Rect(15, 6, 5, 1)).setTo(1.0f);  // a knee
  depth(cv::Rect(15, 7, 5, 1)).setTo(std::numeric_limits<float>::quiet_NaN());
  const cv::Mat mask = staticMaskByMotion(motion, depth, boxes, {}, options);
  EXPECT_EQ(leftOut(mask), 50 + 15);
  EXPECT_EQ(mask.at<std::uint8_t>(5, 16), 0);
  EXPECT_EQ(mask.at<std::uint8_t>(6, 16), 0);
  EXPECT_EQ(mask.at<std::uint8_t>(8, 16), 255) << "the wall in the box";
  EXPECT_EQ(mask.at<std::uint8_t>(6, 30), 255) << "outside the box";
}

TEST(StaticMaskByMotion, LeavesOutAWholeBoxInWhichTheMaskNamesNothing) {
  const std::vector<DetectionBox> boxes{box(10, 5, 12, 8)};
  const cv::Mat as_without = staticMask({40, 20}, boxes, {});
  const cv::Mat unknown(20, 40, CV_8UC1, cv::Scalar(64));
  for (const cv::Mat& motion : {unknown, stillMotion()}) {
    const cv::Mat mask = staticMaskByMotion(motion, depthOf(2.0f), boxes, {});
    EXPECT_EQ(cv::norm(mask, as_without, cv::NORM_INF), 0.0);
  }
  EXPECT_EQ(leftOut(staticMaskByMotion(unknown, depthOf(2.0f), {}, {})), 0);
}

TEST(StaticMaskByMotion, RefusesOtherImages) {
  const cv::Mat depth = depthOf(2.0f);
  EXPECT_THROW(staticMaskByMotion(cv::Mat(20, 40, CV_32SC1), depth, {}, {}), std::invalid_argument);
  EXPECT_THROW(staticMaskByMotion(stillMotion(), depth.t(), {}, {}), std::invalid_argument);
  EXPECT_THROW(staticMaskByMotion(cv::Mat(), cv::Mat(), {}, {}), std::invalid_argument);
  StaticDepthOptions options;
  options.room_behind = -0.1f;
  EXPECT_THROW(staticMaskByMotion(stillMotion(), depth, {}, {}, options), std::invalid_argument);
}

TEST(WithoutLabels, LeavesOutTheLabelledPixelsWithTheMargin) {
  StaticDepthOptions options;
  options.box_margin = 2.0f;
  cv::Mat labels = cv::Mat::zeros(20, 40, CV_32SC1);
  labels.at<int>(5, 10) = 70000;
  labels.at<int>(0, 0) = 1;
  cv::Mat mask(20, 40, CV_8UC1, cv::Scalar(255));
  mask.at<std::uint8_t>(19, 39) = 0;
  const cv::Mat rest = withoutLabels(mask, labels, options);
  EXPECT_EQ(40 * 20 - cv::countNonZero(rest), 25 + 9 + 1);
  EXPECT_EQ(rest.at<std::uint8_t>(7, 12), 0);
  EXPECT_EQ(rest.at<std::uint8_t>(8, 12), 255);
  EXPECT_EQ(cv::countNonZero(mask), 40 * 20 - 1) << "the mask given stays";
  EXPECT_THROW(withoutLabels(mask, labels.t(), options), std::invalid_argument);
  EXPECT_THROW(withoutLabels(mask, cv::Mat(20, 40, CV_8UC3), options), std::invalid_argument);
}

TEST(BoxesToLeaveOut, ArePersonsAndWhateverMoves) {
  const std::vector<DetectionBox> boxes{box(1, 0, 1, 1, 0), box(2, 0, 2, 1, 56),
                                        box(3, 0, 3, 1, 56)};
  const std::vector<std::uint8_t> dynamic{0, 0, 1};
  const std::vector<DetectionBox> left_out = boxesToLeaveOut(boxes, dynamic);
  ASSERT_EQ(left_out.size(), 2U);
  EXPECT_EQ(left_out[0].x_min, 1.0f) << "a person who stands still";
  EXPECT_EQ(left_out[1].x_min, 3.0f) << "a chair that is pushed";
  EXPECT_THROW(boxesToLeaveOut(boxes, {}), std::invalid_argument);
}

TEST(ThinKeyFrame, KeepsEverySecondPixelInMillimetres) {
  cv::Mat depth(5, 8, CV_32F, cv::Scalar(2.0f));
  depth.at<float>(2, 4) = 2.0016f;
  const ThinnedKeyFrame thin = thinKeyFrame(grey(5, 8), depth, {});
  EXPECT_EQ(thin.depth.size(), cv::Size(4, 3));
  EXPECT_EQ(thin.depth.at<std::uint16_t>(1, 2), 2002);
  EXPECT_EQ(thin.depth.at<std::uint16_t>(0, 0), 2000);
  EXPECT_EQ(thin.colour.at<cv::Vec3b>(2, 3), cv::Vec3b(1, 2, 3));
  EXPECT_EQ(cv::countNonZero(thin.usable), 12);
}

TEST(ThinKeyFrame, DepthsOutOfRangeAreKeptButNotUsed) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  StaticDepthOptions options;
  options.stride = 1;
  options.edge_share = 100.0f;
  const cv::Mat depth = (cv::Mat_<float>(1, 7) << 0.1f, 5.0f, 0.0f, nan, -1.0f, 40.0f, 2.0f);
  const ThinnedKeyFrame thin = thinKeyFrame(grey(1, 7), depth, {}, options);
  const std::vector<std::uint16_t> expected{100, 5000, 0, 0, 0, 0, 2000};
  EXPECT_EQ(std::vector<std::uint16_t>(thin.depth.begin<std::uint16_t>(),
                                       thin.depth.end<std::uint16_t>()),
            expected);
  EXPECT_EQ(cv::countNonZero(thin.usable), 1);
  EXPECT_EQ(thin.usable.at<std::uint8_t>(0, 6), 255);
}

TEST(ThinKeyFrame, PixelsAtAJumpAndUnderTheMaskAreNotUsed) {
  StaticDepthOptions options;
  options.stride = 1;
  cv::Mat depth(1, 10, CV_32F, cv::Scalar(1.0f));
  depth.colRange(5, 10) = 2.0f;
  cv::Mat mask(1, 10, CV_8U, cv::Scalar(255));
  mask.at<std::uint8_t>(0, 9) = 0;
  const ThinnedKeyFrame thin = thinKeyFrame(grey(1, 10), depth, mask, options);
  // Two pixels on each side of the jump between columns 4 and 5, and the masked one.
  const std::vector<std::uint8_t> expected{255, 255, 255, 0, 0, 0, 0, 255, 255, 0};
  EXPECT_EQ(
      std::vector<std::uint8_t>(thin.usable.begin<std::uint8_t>(), thin.usable.end<std::uint8_t>()),
      expected);
}

TEST(ThinKeyFrame, RefusesWhatDoesNotFit) {
  const cv::Mat depth(4, 4, CV_32F, cv::Scalar(1.0f));
  EXPECT_THROW(thinKeyFrame({}, {}, {}), std::invalid_argument);
  EXPECT_THROW(thinKeyFrame(grey(4, 5), depth, {}), std::invalid_argument);
  EXPECT_THROW(thinKeyFrame(grey(4, 4), cv::Mat(4, 4, CV_16U), {}), std::invalid_argument);
  EXPECT_THROW(thinKeyFrame(grey(4, 4), depth, cv::Mat(4, 4, CV_32F)), std::invalid_argument);
  StaticDepthOptions options;
  options.stride = 0;
  EXPECT_THROW(thinKeyFrame(grey(4, 4), depth, {}, options), std::invalid_argument);
  options = {};
  options.max_depth = 40.0f;
  EXPECT_THROW(staticMask({4, 4}, {}, {}, options), std::invalid_argument);
  EXPECT_THROW(staticMask({0, 4}, {}, {}), std::invalid_argument);
}

}  // namespace
}  // namespace hmcdyn::slam

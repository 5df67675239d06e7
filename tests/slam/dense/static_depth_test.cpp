// SPDX-License-Identifier: BSD-3-Clause
#include "slam/dense/static_depth.hpp"

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

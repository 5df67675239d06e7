// SPDX-License-Identifier: BSD-3-Clause
// Drawn images: a textured thing before a wall, both seen by a camera that moves to the right.
#include "slam/detection/motion_regions.hpp"

#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "pipeline/toy_sequence.hpp"

namespace hmcdyn::slam {
namespace {

/// Frames at 20 Hz, 640 x 480 px; the thing is 120 x 200 px at 1.5 m, the wall at 3 m.
class Regions : public testing::Test {
 protected:
  RgbdFrame frameAt(std::size_t index, int left, int top = 140) const {
    RgbdFrame frame;
    frame.index = index;
    frame.timestamp = 10.0 + 0.05 * static_cast<double>(index);
    frame.gray = wall_.clone();
    frame.depth = cv::Mat(480, 640, CV_32FC1, cv::Scalar(3.0));
    const cv::Rect thing(left, top, 120, 200);
    thing_.copyTo(frame.gray(thing));
    frame.depth(thing).setTo(1.5);
    return frame;
  }

  cv::Mat wall_ = test::makeTexture({640, 480}, 7);
  cv::Mat thing_ = test::makeTexture({120, 200}, 8);
};

TEST_F(Regions, AThingThatMovesIsOneRegionAroundIt) {
  MotionRegions regions;
  std::vector<DetectionBox> boxes;
  for (std::size_t i = 0; i < 8; ++i) {
    boxes = regions.update(frameAt(i, 200 + 4 * static_cast<int>(i)));
  }
  ASSERT_EQ(boxes.size(), 1U);
  EXPECT_EQ(boxes[0].class_id, kUnknownClassId);
  EXPECT_GE(boxes[0].score, 0.4f);
  EXPECT_NEAR(boxes[0].x_min, 228.0f, 9.0f);
  EXPECT_NEAR(boxes[0].x_max, 348.0f, 9.0f);
  EXPECT_NEAR(boxes[0].y_min, 140.0f, 9.0f);
  EXPECT_NEAR(boxes[0].y_max, 340.0f, 9.0f);
}

TEST_F(Regions, AThingAtRestIsNone) {
  MotionRegions regions;
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_TRUE(regions.update(frameAt(i, 200)).empty()) << i;
  }
}

TEST_F(Regions, AThingThatPausesStaysOneUntilTheAgeLimit) {
  MotionRegionOptions options;
  options.max_pause = 0.5;
  MotionRegions regions(options);
  for (std::size_t i = 0; i < 8; ++i) {
    regions.update(frameAt(i, 200 + 4 * static_cast<int>(i)));
  }
  // It stands from frame 7 on. With 0.15 s between the compared frames, frame 9 is the last that
  // can see it move; half a second is ten frames more.
  std::size_t last = 7;
  for (std::size_t i = 8; i < 30; ++i) {
    if (!regions.update(frameAt(i, 228)).empty()) {
      EXPECT_EQ(i, last + 1);
      last = i;
    }
  }
  EXPECT_GE(last, 17U);
  EXPECT_LE(last, 20U);
}

TEST_F(Regions, OneFrameOrNoDepthGivesNone) {
  MotionRegions regions;
  EXPECT_TRUE(regions.update(frameAt(0, 200)).empty());
  for (std::size_t i = 1; i < 6; ++i) {
    RgbdFrame frame = frameAt(i, 200 + 4 * static_cast<int>(i));
    frame.depth.setTo(0.0);
    EXPECT_TRUE(regions.update(frame).empty());
  }
}

TEST(SegmentDepth, AFloorDoesNotJoinWhatStandsOnIt) {
  // 320 x 240 px; a wall at 6 m in the upper half, a floor that comes near below it, z = 720 / (v -
  // 0), and two things at 4 m that stand on the floor's row 180.
  cv::Mat depth(240, 320, CV_32FC1, cv::Scalar(6.0));
  for (int v = 120; v < 240; ++v) {
    depth.row(v).setTo(720.0 / v);
  }
  depth(cv::Rect(40, 80, 60, 101)).setTo(4.0);
  depth(cv::Rect(200, 80, 60, 101)).setTo(4.0);
  const DepthSegments segments = segmentDepth(depth, {});
  std::vector<cv::Rect> things;
  for (const cv::Rect& rect : segments.rect) {
    if (rect.height > 20 && rect.width < 30) {
      things.push_back(rect);
    }
  }
  ASSERT_EQ(things.size(), 2U);
  EXPECT_NEAR(things[0].x, 10, 1);
  EXPECT_NEAR(things[0].width, 15, 1);
  EXPECT_NEAR(things[1].x, 50, 1);
}

TEST(SegmentDepth, RefusesAnotherType) {
  EXPECT_THROW(segmentDepth(cv::Mat(), {}), std::invalid_argument);
  EXPECT_THROW(segmentDepth(cv::Mat(8, 8, CV_16UC1), {}), std::invalid_argument);
}

TEST(MotionRegionOptionsCheck, RefusesWhatCannotBe) {
  MotionRegionOptions options;
  options.baseline = 1.0;  // above the history
  EXPECT_THROW(MotionRegions{options}, std::invalid_argument);
}

}  // namespace
}  // namespace hmcdyn::slam

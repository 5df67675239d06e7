// SPDX-License-Identifier: BSD-3-Clause
#include "slam/detect/box_selection.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

#include "slam/detect/coco_classes.hpp"

namespace hmcdyn::slam {
namespace {

TEST(SuppressOverlaps, TheStrongerOfTwoInOneClassStays) {
  // Given two boxes of 100 px2 that share 60: intersection over union 60 / 140 = 0.43.
  const std::vector<DetectionBox> boxes{{0, 0, 10, 10, 0, 0.6f}, {4, 0, 14, 10, 0, 0.9f}};
  ASSERT_EQ(suppressOverlaps(boxes, 0.42f).size(), 1U);
  EXPECT_EQ(suppressOverlaps(boxes, 0.42f)[0].score, 0.9f);
  ASSERT_EQ(suppressOverlaps(boxes, 0.44f).size(), 2U);
  EXPECT_EQ(suppressOverlaps(boxes, 0.44f)[0].score, 0.9f);  // strongest first
}

TEST(SuppressOverlaps, ClassesDoNotMeet) {
  const std::vector<DetectionBox> boxes{{0, 0, 10, 10, 0, 0.6f}, {0, 0, 10, 10, 56, 0.9f}};
  const std::vector<DetectionBox> kept = suppressOverlaps(boxes, 0.1f);
  ASSERT_EQ(kept.size(), 2U);
  EXPECT_EQ(kept[0].class_id, 56);
  EXPECT_EQ(kept[1].class_id, 0);
}

TEST(SuppressOverlaps, ABoxSuppressedDoesNotSuppress) {
  // Each overlaps the next by 5 / 15 = 0.33, the first and the last not at all.
  const std::vector<DetectionBox> boxes{
      {0, 0, 10, 10, 0, 0.9f}, {5, 0, 15, 10, 0, 0.8f}, {10, 0, 20, 10, 0, 0.7f}};
  const std::vector<DetectionBox> kept = suppressOverlaps(boxes, 0.3f);
  ASSERT_EQ(kept.size(), 2U);
  EXPECT_EQ(kept[1].x_min, 10.0f);
}

TEST(SuppressOverlaps, EqualScoresKeepTheirOrder) {
  const std::vector<DetectionBox> boxes{
      {50, 0, 60, 10, 9, 0.5f}, {0, 0, 10, 10, 0, 0.5f}, {20, 0, 30, 10, 9, 0.5f}};
  const std::vector<DetectionBox> kept = suppressOverlaps(boxes, 0.5f);
  ASSERT_EQ(kept.size(), 3U);
  EXPECT_EQ(kept[0].x_min, 50.0f);
  EXPECT_EQ(kept[1].x_min, 0.0f);
  EXPECT_EQ(kept[2].x_min, 20.0f);
}

TEST(SuppressOverlaps, NothingGivesNothing) { EXPECT_TRUE(suppressOverlaps({}, 0.5f).empty()); }

TEST(KeepWanted, ScoreAndClassDecide) {
  const std::vector<DetectionBox> boxes{
      {0, 0, 1, 1, 0, 0.25f}, {0, 0, 1, 1, 0, 0.24f}, {0, 0, 1, 1, 16, 0.9f}};
  DetectorOptions options;
  options.score_threshold = 0.25f;
  EXPECT_EQ(keepWanted(boxes, options).size(), 2U);
  options.classes = {0, 2};
  ASSERT_EQ(keepWanted(boxes, options).size(), 1U);
  EXPECT_EQ(keepWanted(boxes, options)[0].score, 0.25f);
}

TEST(ClipToImage, CutsAtTheOutermostPixels) {
  const std::vector<DetectionBox> clipped =
      clipToImage({{-5, -6, 700, 500}, {10, 20, 30, 40}, {639, 0, 800, 10}}, {640, 480});
  ASSERT_EQ(clipped.size(), 3U);
  EXPECT_EQ(clipped[0].x_min, 0.0f);
  EXPECT_EQ(clipped[0].y_min, 0.0f);
  EXPECT_EQ(clipped[0].x_max, 639.0f);
  EXPECT_EQ(clipped[0].y_max, 479.0f);
  EXPECT_EQ(clipped[1].x_max, 30.0f);
  EXPECT_EQ(clipped[2].x_max, 639.0f);
}

TEST(ClipToImage, ABoxOutsideGoesAndAnInvertedOneStays) {
  const std::vector<DetectionBox> clipped = clipToImage(
      {{-50, 0, -1, 10}, {640, 0, 700, 10}, {0, 480, 10, 500}, {700, 10, -10, 20}}, {640, 480});
  ASSERT_EQ(clipped.size(), 1U);
  EXPECT_EQ(clipped[0].x_min, 700.0f);
  EXPECT_EQ(clipped[0].x_max, -10.0f);
}

TEST(CocoClasses, NamesAndNumbersBelongTogether) {
  EXPECT_EQ(cocoClassName(0), "person");
  EXPECT_EQ(cocoClassName(9), "traffic light");
  EXPECT_EQ(cocoClassName(56), "chair");
  EXPECT_EQ(cocoClassName(62), "tv");
  EXPECT_EQ(cocoClassName(79), "toothbrush");
  for (int class_id = 0; class_id < kCocoClassCount; ++class_id) {
    EXPECT_EQ(findCocoClass(cocoClassName(class_id)), class_id);
  }
}

TEST(CocoClasses, OtherSpellingsAreKnownAndOtherNamesAreNot) {
  EXPECT_EQ(findCocoClass("traffic_light"), 9);
  EXPECT_EQ(findCocoClass("tvmonitor"), 62);
  EXPECT_EQ(findCocoClass("sofa"), 57);
  EXPECT_FALSE(findCocoClass("robot").has_value());
  EXPECT_FALSE(findCocoClass("").has_value());
  EXPECT_THROW(cocoClassName(-1), std::invalid_argument);
  EXPECT_THROW(cocoClassName(80), std::invalid_argument);
}

}  // namespace
}  // namespace hmcdyn::slam

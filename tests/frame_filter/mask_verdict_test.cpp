// SPDX-License-Identifier: BSD-3-Clause
#include "frame_filter/mask_verdict.hpp"

#include <cstdint>
#include <limits>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

namespace hmcdyn::internal {
namespace {

/// 60 x 40 px of room, and columns 20 to 29 that move from row 10 on.
MotionMask maskOfRoomWithThing() {
  MotionMask mask;
  mask.state = MaskState::kGood;
  mask.label = cv::Mat::zeros(40, 60, CV_8UC1);
  mask.label(cv::Rect(20, 10, 10, 30)) = static_cast<std::uint8_t>(MaskLabel::kMoving);
  return mask;
}

MaskLabel labelAt(const MotionMask& mask, float u, float v) {
  KeyPoints point;
  point.u = {u};
  point.v = {v};
  point.depth = {1.0f};
  return labelsAt(point.view(), mask).at(0);
}

TEST(LabelsAt, AreThoseOfTheNearestPixel) {
  const MotionMask mask = maskOfRoomWithThing();
  EXPECT_EQ(labelAt(mask, 24.0f, 20.0f), MaskLabel::kMoving);
  EXPECT_EQ(labelAt(mask, 29.4f, 39.7f), MaskLabel::kMoving);
  EXPECT_EQ(labelAt(mask, 50.0f, 20.0f), MaskLabel::kStatic);
  EXPECT_EQ(labelAt(mask, -3.0f, 70.0f), MaskLabel::kStatic) << "the border's";
  EXPECT_EQ(labelAt(mask, std::numeric_limits<float>::quiet_NaN(), 20.0f), MaskLabel::kUnknown);
}

TEST(LabelsAt, DoNotVouchForCornersOfASilhouette) {
  const MotionMask mask = maskOfRoomWithThing();
  for (const float beside : {16.0f, 19.0f, 30.0f, 33.0f}) {
    EXPECT_EQ(labelAt(mask, beside, 20.0f), MaskLabel::kUnknown) << "column " << beside;
  }
  for (const float clear : {15.0f, 34.0f}) {
    EXPECT_EQ(labelAt(mask, clear, 20.0f), MaskLabel::kStatic) << "column " << clear;
  }
  EXPECT_EQ(labelAt(mask, 25.0f, 6.0f), MaskLabel::kUnknown);
  EXPECT_EQ(labelAt(mask, 25.0f, 5.0f), MaskLabel::kStatic);
  MotionMask standing = mask;
  standing.label(cv::Rect(30, 10, 5, 30)) = static_cast<std::uint8_t>(MaskLabel::kStanding);
  EXPECT_EQ(labelAt(standing, 31.0f, 20.0f), MaskLabel::kStanding);
}

TEST(LabelsAt, AreUnknownWhereTheMaskIsWorthNothing) {
  MotionMask mask = maskOfRoomWithThing();
  for (const MaskState state : {MaskState::kFirstFrame, MaskState::kMotionDoubtful}) {
    mask.state = state;
    EXPECT_EQ(labelAt(mask, 24.0f, 20.0f), MaskLabel::kUnknown);
  }
  mask.state = MaskState::kTooLarge;
  EXPECT_EQ(labelAt(mask, 24.0f, 20.0f), MaskLabel::kMoving);
}

}  // namespace
}  // namespace hmcdyn::internal

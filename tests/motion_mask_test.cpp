// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <hmcdyn/motion_mask.hpp>

#include "sliding_thing.hpp"

namespace hmcdyn {
namespace {

using test::shareOf;
using test::SlidingThing;

constexpr double kPeriod = 1.0 / 30.0;  // (s)
constexpr double kSpeed = 0.5;          // (m/s) of the board where it moves

/// Where the board is that moves from a start until a time, then stands (s, m).
double boardAt(double t, double until = 1e9) { return -0.6 + kSpeed * std::min(t, until); }

cv::Mat wallOf(const SlidingThing& scene) { return scene.truth() == 0; }

TEST(MotionMask, AThingThatMovesIsFoundWithoutABoxAndTheRoomIsNot) {
  // Given a board that moves across, seen by a camera that moves, too
  MotionMaskEstimator estimator(SlidingThing::kCamera);
  for (int k = 0; k < 40; ++k) {
    const double t = k * kPeriod;
    const SlidingThing scene(t, 0.1 * std::sin(3.0 * t), boardAt(t));
    // When the mask is asked for
    const MotionMask& mask = estimator.update(scene.frame());
    // Then the board is found 0.3 s after the start, and all of it once it has moved by its width
    const double width = SlidingThing::kBoardWidth;
    if (k >= 10) {
      EXPECT_EQ(mask.state, MaskState::kGood);
      EXPECT_GT(shareOf(mask.label, MaskLabel::kMoving, scene.truth()),
                kSpeed * t < width ? 0.5 : 0.95)
          << k;
      EXPECT_LT(shareOf(mask.label, MaskLabel::kMoving, wallOf(scene)), 0.01) << k;
    }
  }
}

TEST(MotionMask, WithoutAGrayImageDepthAloneFindsIt) {
  MotionMaskEstimator estimator(SlidingThing::kCamera);
  cv::Mat label;
  SlidingThing last(0.0, 0.0, 0.0);
  for (int k = 0; k < 30; ++k) {
    last = SlidingThing(k * kPeriod, 0.0, boardAt(k * kPeriod));
    last.frame().gray = cv::Mat();
    label = estimator.update(last.frame()).label;
  }
  EXPECT_GT(shareOf(label, MaskLabel::kMoving, last.truth()), 0.95);
  EXPECT_LT(shareOf(label, MaskLabel::kMoving, wallOf(last)), 0.01);
}

/// Belief at (u, v) of a static wall just when a part of it became brighter by 50 gray levels.
float beliefInALight(const cv::Rect& lit, int u, int v) {
  MotionMaskEstimator estimator(SlidingThing::kCamera);
  float belief = 0.0f;
  for (int k = 0; k <= 15; ++k) {
    SlidingThing scene(k * kPeriod, 0.0, 5.0);  // the board is outside
    if (k == 15) {
      scene.frame().gray(lit) += cv::Scalar(50);
    }
    belief = estimator.update(scene.frame()).belief.at<float>(v, u);
  }
  return belief;
}

TEST(MotionMask, AnotherGrayLevelSpeaksForMotionOnlyWhereTheImagesAgreeElsewhere) {
  // A patch of 8 % of the image may be something that came; a third of it is in another light (the
  // mean rises by 18 of the 20 gray levels that make images incomparable)
  EXPECT_GT(beliefInALight({60, 40, 40, 40}, 80, 60), 0.0f);
  EXPECT_LT(beliefInALight({0, 0, 58, SlidingThing::kHeight}, 29, 60), 0.0f);
}

TEST(MotionMask, AThingWhoseTrailingEdgeAloneIsSeenIsFoundByThePlaceItLeft) {
  // By depth alone, 0.3 s after a board began to leave the image to the right: its leading edge is
  // outside from the start, so nothing of it stands where there was free space
  MotionMaskEstimator estimator(SlidingThing::kCamera);
  cv::Mat label;
  SlidingThing last(0.0, 0.0, 0.6);
  for (int k = 0; k < 10; ++k) {
    last = SlidingThing(k * kPeriod, 0.0, 0.6 + kSpeed * k * kPeriod);
    last.frame().gray = cv::Mat();
    label = estimator.update(last.frame()).label;
  }
  EXPECT_EQ(cv::countNonZero((label == 255) & (wallOf(last) != 0)), 0);
  EXPECT_GT(shareOf(label, MaskLabel::kMoving, last.truth()), 0.9);
}

TEST(MotionMask, WhatMovesAndBecomesSlowGoesOnMoving) {
  // A board that came at 0.5 m/s and drifts on by 0.1 m/s: in 0.2 s by 4 % of its width, which is
  // less than it takes to begin
  MotionMaskEstimator estimator(SlidingThing::kCamera);
  double share = 0.0;
  for (int k = 0; k < 50; ++k) {
    const double t = k * kPeriod;
    const SlidingThing scene(t, 0.0, boardAt(t, 1.2) + 0.1 * std::max(0.0, t - 1.2));
    const MotionMask& mask = estimator.update(scene.frame());
    share = shareOf(mask.label, MaskLabel::kMoving, scene.truth());
  }
  EXPECT_GT(share, 0.9);
}

TEST(MotionMask, AThingKeepsItsNumberAndHasItsVelocityInTheWorld) {
  // Given a camera that moves the other way
  MotionMaskEstimator estimator(SlidingThing::kCamera);
  int number = 0;
  for (int k = 0; k < 40; ++k) {
    const double t = k * kPeriod;
    const MotionMask& mask = estimator.update(SlidingThing(t, -0.2 * t, boardAt(t)).frame());
    if (k < 15) {
      continue;
    }
    // Then there is one thing, with one number and the board's velocity
    ASSERT_EQ(mask.instances.size(), 1U) << k;
    const MaskInstance& thing = mask.instances.front();
    number = number == 0 ? thing.number : number;
    EXPECT_EQ(thing.number, number) << k;
    EXPECT_TRUE(thing.moves);
    EXPECT_EQ(thing.decided_by, MaskReason::kFreeSpace);
    EXPECT_NEAR(thing.depth, SlidingThing::kBoard, 0.1);
    ASSERT_TRUE(thing.has_velocity) << k;
    EXPECT_NEAR(thing.velocity[0], kSpeed, 0.15) << k;
    EXPECT_NEAR(thing.velocity[1], 0.0, 0.1) << k;
    EXPECT_NEAR(thing.velocity[2], 0.0, 0.1) << k;
  }
}

TEST(MotionMask, ACameraThatMovesInARoomAtRestSeesNothingMove) {
  MotionMaskEstimator estimator(SlidingThing::kCamera);
  for (int k = 0; k < 60; ++k) {
    const double t = k * kPeriod;
    const SlidingThing scene(t, 0.3 * std::sin(2.0 * t), -0.2);
    const MotionMask& mask = estimator.update(scene.frame());
    EXPECT_EQ(cv::countNonZero(mask.label == 255), 0) << k;
    EXPECT_TRUE(mask.instances.empty()) << k;
    EXPECT_GT(mask.agreement, 0.98f) << k;
  }
}

TEST(MotionMask, WhoStopsIsSoonStandingAndStaysKnown) {
  // Given a board that moves for a second and stands for another one
  MotionMaskEstimator estimator(SlidingThing::kCamera);
  for (int k = 0; k < 60; ++k) {
    const double t = k * kPeriod;
    const SlidingThing scene(t, 0.0, boardAt(t, 1.0));
    const MotionMask& mask = estimator.update(scene.frame());
    // Then from 0.3 s after the stop on it stands, and is not the room
    if (t > 1.3) {
      EXPECT_LT(shareOf(mask.label, MaskLabel::kMoving, scene.truth()), 0.05) << t;
      EXPECT_GT(shareOf(mask.label, MaskLabel::kStanding, scene.truth()), 0.9) << t;
    }
  }
}

/// The mask of the second frame of a room at rest. The first one was given 0.3 m too far from the
/// wall; its pose was told anew under a stamp.
MaskState stateAfterPoseWasTold(double stamp) {
  MotionMaskEstimator estimator(SlidingThing::kCamera);
  SlidingThing first(0.0, 0.0, -0.2);
  const Pose right = first.frame().camera_from_world;
  first.frame().camera_from_world.matrix(2, 3) = 0.3;
  estimator.update(first.frame());
  estimator.setPose(stamp, right);
  return estimator.update(SlidingThing(kPeriod, 0.0, -0.2).frame()).state;
}

TEST(MotionMask, APoseThatIsToldAfterwardsReplacesTheOneBefore) {
  EXPECT_EQ(stateAfterPoseWasTold(0.0), MaskState::kGood);
}

TEST(MotionMask, APoseOfAStampThatIsNotRememberedIsIgnored) {
  EXPECT_EQ(stateAfterPoseWasTold(0.001), MaskState::kMotionDoubtful);
}

TEST(MotionMask, APoseToldThatIsNotFiniteIsIgnored) {
  MotionMaskEstimator estimator(SlidingThing::kCamera);
  estimator.update(SlidingThing(0.0, 0.0, -0.2).frame());
  Pose broken;
  broken.matrix(0, 0) = std::numeric_limits<double>::quiet_NaN();
  estimator.setPose(0.0, broken);
  const SlidingThing next(kPeriod, 0.0, -0.2);
  EXPECT_GT(shareOf(estimator.update(next.frame()).label, MaskLabel::kStatic, wallOf(next)), 0.99);
}

TEST(MotionMask, ABoxNamesWhatStandsButDoesNotMakeItMove) {
  // Given a board that never moved
  MotionMaskEstimator without(SlidingThing::kCamera);
  MotionMaskEstimator with(SlidingThing::kCamera);
  for (int k = 0; k < 30; ++k) {
    SlidingThing scene(k * kPeriod, 0.0, -0.2);
    const cv::Mat room = without.update(scene.frame()).label;
    const std::vector<DetectionBox> boxes = {scene.box()};
    scene.frame().regions = boxes;
    const cv::Mat named = with.update(scene.frame()).label;
    if (k > 0) {
      EXPECT_GT(shareOf(room, MaskLabel::kStatic, scene.truth()), 0.99);
      EXPECT_GT(shareOf(named, MaskLabel::kStanding, scene.truth()), 0.95);
      EXPECT_EQ(cv::countNonZero(named == 255), 0);
      // in the box only what was there 0.35 s ago, too, is of the room
      EXPECT_GT(shareOf(named, MaskLabel::kStatic, wallOf(scene)), 0.98);
      EXPECT_EQ(shareOf(named, MaskLabel::kMoving, wallOf(scene)), 0.0);
    }
  }
}

TEST(MotionMask, ARegionOfALabelImageNamesItsPixels) {
  MotionMaskEstimator estimator(SlidingThing::kCamera);
  const std::vector<LabelRegion> regions = {{255}};
  for (int k = 0; k < 10; ++k) {
    SlidingThing scene(k * kPeriod, 0.0, -0.2);
    scene.frame().regions = Regions(scene.truth(), regions);
    const MotionMask& mask = estimator.update(scene.frame());
    if (k > 0) {
      EXPECT_DOUBLE_EQ(shareOf(mask.label, MaskLabel::kStanding, scene.truth()), 1.0);
    }
  }
}

TEST(MotionMask, HolesInsideAThingBelongToItAndOthersAreUnknown) {
  MotionMaskEstimator estimator(SlidingThing::kCamera);
  cv::Mat label;
  SlidingThing last(0.0, 0.0, 0.0);
  const cv::Rect on_wall(120, 5, 6, 6);
  cv::Rect on_board;
  for (int k = 0; k < 30; ++k) {
    last = SlidingThing(k * kPeriod, 0.0, boardAt(k * kPeriod));
    on_board = cv::Rect(static_cast<int>(last.box().x_min) + 15, 50, 10, 10);
    last.frame().depth(on_board) = 0.0f;
    last.frame().depth(on_wall) = 0.0f;
    label = estimator.update(last.frame()).label;
  }
  EXPECT_EQ(cv::countNonZero(label(on_board) == 255), on_board.area());
  EXPECT_EQ(cv::countNonZero(label(on_wall) == 64), on_wall.area());
}

TEST(MotionMask, TheSameFramesGiveTheSameMasks) {
  MotionMaskEstimator one(SlidingThing::kCamera);
  MotionMaskEstimator two(SlidingThing::kCamera);
  for (int k = 0; k < 20; ++k) {
    const SlidingThing scene(k * kPeriod, 0.0, boardAt(k * kPeriod));
    const cv::Mat first = one.update(scene.frame()).label;
    const cv::Mat second = two.update(scene.frame()).label;
    EXPECT_EQ(cv::countNonZero(first != second), 0) << k;
  }
}

TEST(MotionMask, AMaskThatCoversTooMuchIsReportedAndGivenAllTheSame) {
  // Given a limit below the board's share of the image, 0.14
  MotionMaskOptions options;
  options.max_moving_share = 0.05f;
  MotionMaskEstimator estimator(SlidingThing::kCamera, options);
  MaskState state = MaskState::kGood;
  cv::Mat label;
  SlidingThing last(0.0, 0.0, 0.0);
  for (int k = 0; k < 30; ++k) {
    last = SlidingThing(k * kPeriod, 0.0, boardAt(k * kPeriod));
    const MotionMask& mask = estimator.update(last.frame());
    state = mask.state;
    label = mask.label;
  }
  EXPECT_EQ(state, MaskState::kTooLarge);
  EXPECT_GT(shareOf(label, MaskLabel::kMoving, last.truth()), 0.95);
}

TEST(StaticDepth, LeavesOutWhatMovesAndWhatStands) {
  const cv::Mat depth = (cv::Mat_<float>(1, 4) << 1.0f, 2.0f, 3.0f, 4.0f);
  const cv::Mat label = (cv::Mat_<std::uint8_t>(1, 4) << 0, 64, 128, 255);
  EXPECT_EQ(cv::countNonZero(staticDepth(depth, label) !=
                             (cv::Mat_<float>(1, 4) << 1.0f, 2.0f, 0.0f, 0.0f)),
            0);
  EXPECT_EQ(cv::countNonZero(staticDepth(depth, label, true) !=
                             (cv::Mat_<float>(1, 4) << 1.0f, 2.0f, 3.0f, 0.0f)),
            0);
}

}  // namespace
}  // namespace hmcdyn

// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include <hmcdyn/votes/motion_belief.hpp>

#include "belief_frame.hpp"
#include "constants.hpp"

namespace hmcdyn {
namespace {

using test::kInfinity;

using Frame = test::BeliefFrame;
using test::update;

/// The kernel's closed form.
double kernel(double q) { return std::pow(std::max(0.0, 1.0 - q / 8.0), 4); }

TEST(MotionBelief, TwoPointsListenToEachOther) {
  // Given one that moves (vote 1, weight 1) and one at rest (vote 0, weight 0.3), sigma apart:
  // (1 - 1/8)^4 = 0.586182
  const MotionBelief belief = update(Frame().add(100, 50, 2.0f, 2.0f).add(180, 50, 2.0f, 0.1f));
  EXPECT_NEAR(belief.belief[0], 1.0 / (1.0 + 0.3 * 0.586182), 1e-5);
  EXPECT_NEAR(belief.belief[1], 0.586182 / (0.586182 + 0.3), 1e-5);
  EXPECT_NEAR(belief.weight[0], 0.9 * (1.0 + 0.3 * 0.586182) / 20.0, 1e-6);
  EXPECT_NEAR(belief.weight[1], 0.9 * (0.586182 + 0.3) / 20.0, 1e-6);
}

TEST(MotionBelief, DepthSeparatesAsTheImageDoes) {
  // Given the same two, and a depth reach apart as well: (1 - 2/8)^4 = 0.31640625 at 2 m, and by
  // the reach of 0.03 + 0.02 * 2.11^2 = 0.119042 m at 2.11 m.
  const MotionBelief belief = update(Frame().add(100, 50, 2.0f, 2.0f).add(180, 50, 2.11f, 0.1f));
  EXPECT_NEAR(belief.belief[0], 1.0 / (1.0 + 0.3 * 0.31640625), 1e-4);
  const double back = kernel(1.0 + std::pow(0.11 / 0.119042, 2));
  EXPECT_NEAR(belief.belief[1], back / (back + 0.3), 1e-4);
}

TEST(MotionBelief, BeyondItsReachAVoteDoesNotCount) {
  // Given sqrt(8) sigma = 226.27 px
  EXPECT_EQ(update(Frame().add(0, 50, 2.0f, 2.0f).add(227, 50, 2.0f, 0.1f)).belief[1], 0.0f);
  EXPECT_GT(update(Frame().add(0, 50, 2.0f, 2.0f).add(200, 50, 2.0f, 0.1f)).belief[1], 0.0f);
  // ... and sqrt(8) * 0.11 = 0.311 m
  EXPECT_EQ(update(Frame().add(0, 50, 2.0f, 2.0f).add(0, 50, 2.4f, 0.1f)).belief[0], 1.0f);
}

TEST(MotionBelief, AloneAPointIsWhatItsDistanceSays) {
  const auto alone = [](float distance, PointLabel label) {
    Frame frame;
    frame.add(100, 50, 2.0f, distance);
    frame.label[0] = label;
    return update(frame).belief[0];
  };
  EXPECT_FLOAT_EQ(alone(0.1f, PointLabel::kSuspect), 0.0f);
  EXPECT_FLOAT_EQ(alone(0.3f, PointLabel::kSuspect), 0.0f);
  EXPECT_NEAR(alone(0.65f, PointLabel::kSuspect), 0.5, 1e-6);
  EXPECT_FLOAT_EQ(alone(1.0f, PointLabel::kSuspect), 1.0f);
  EXPECT_FLOAT_EQ(alone(kInfinity, PointLabel::kSuspect), 1.0f);
  // A dynamic cluster's quiet point counts with at least a half.
  EXPECT_FLOAT_EQ(alone(0.1f, PointLabel::kDynamic), 0.5f);
  EXPECT_FLOAT_EQ(alone(1.0f, PointLabel::kDynamic), 1.0f);
}

TEST(MotionBelief, ADraggedCornerIsOutvotedByItsWall) {
  // Given six points of a wall at rest, 40 px around a corner that the person before it drags
  Frame frame;
  frame.add(6, 140, 50, 4.0f, 0.1f).add(100, 50, 4.0f, 3.0f).dragged();
  frame.add(6, 95, 50, 2.0f, 3.0f);
  const MotionBelief belief = update(frame);

  // Then the corner is believed at rest: (1 - 0.25/8)^4 = 0.880748
  EXPECT_NEAR(belief.belief[6], 0.05 / (0.05 + 6 * 0.3 * 0.880748), 1e-5);
  EXPECT_EQ(belief.weight[6], 0.0f);  // and no memory of it is kept
  EXPECT_NEAR(belief.belief[7], 1.0, 1e-6);

  // Without the flow's drag known, it would not have been.
  frame.surface.is_dragged[6] = 0;
  EXPECT_NEAR(update(frame).belief[6], 1.0 / (1.0 + 6 * 0.3 * 0.880748), 1e-5);
}

TEST(MotionBelief, AStillArmGoesWithItsBody) {
  // Given eight moving points of a body 30 px from an arm at rest
  const MotionBelief belief = update(Frame().add(8, 100, 50, 2.0f, 2.0f).add(130, 50, 2.0f, 0.1f));
  const double votes = 8 * kernel(30.0 * 30.0 / 6400.0);
  EXPECT_NEAR(belief.belief[8], votes / (votes + 0.3), 1e-5);
  EXPECT_GT(belief.belief[8], test::fixedBeliefOptions().dynamic_belief);
}

TEST(MotionBelief, WhoPausesStaysDynamicForThreeFrames) {
  // Given 20 points of a person that moved: certain, 0.9 after the decay
  const Frame moving = Frame().add(20, 100, 50, 2.0f, 2.0f);
  const Frame resting = Frame().add(20, 100, 50, 2.0f, 0.0f);
  MotionBelief belief = update(moving);
  EXPECT_NEAR(belief.belief[0], 1.0, 1e-6);
  EXPECT_NEAR(belief.weight[0], 0.9, 1e-6);

  // When they rest, each frame weighs a memory of 2 * 20 * 0.9 = 36 against 20 * 0.3 = 6:
  // 6/7 is left, and (6/7)^3 = 0.63, (6/7)^4 = 0.54.
  std::vector<bool> is_dynamic;
  for (int k = 1; k <= 5; ++k) {
    belief = update(resting, belief);
    EXPECT_NEAR(belief.belief[0], std::pow(6.0 / 7.0, k), 1e-5) << "frame " << k;
    is_dynamic.push_back(belief.belief[0] > test::fixedBeliefOptions().dynamic_belief);
  }
  EXPECT_EQ(is_dynamic, (std::vector<bool>{true, true, true, false, false}));
}

TEST(MotionBelief, AWallMisjudgedOnceRecovers) {
  // Given a wall outside the boxes that was believed to move
  MotionBelief belief = update(Frame().add(20, 100, 50, 2.0f, 2.0f));
  const Frame wall = Frame().add(20, 100, 50, 2.0f, 0.0f).outsideBoxes();

  // Then rest weighs 20 against 36 there: 9/14 = 0.643 is dynamic, its square is not, ...
  belief = update(wall, belief);
  EXPECT_NEAR(belief.belief[0], 9.0 / 14.0, 1e-5);
  belief = update(wall, belief);
  EXPECT_NEAR(belief.belief[0], 81.0 / 196.0, 1e-5);
  // ... and what is not believed to move outside the boxes is at rest again.
  belief = update(wall, belief);
  EXPECT_EQ(belief.belief[0], 0.0f);
  EXPECT_NEAR(belief.weight[0], 0.9, 1e-6);
}

TEST(MotionBelief, AMissedDetectionIsBridged) {
  // Given a person that moved in a box, and then moves on without one, beside a wall 200 px off
  const MotionBelief memory = update(Frame().add(20, 100, 50, 2.0f, 2.0f));
  const Frame missed =
      Frame().add(20, 100, 50, 2.0f, 2.0f).add(5, 300, 50, 2.0f, 2.0f).outsideBoxes();
  const MotionBelief belief = update(missed, memory);
  EXPECT_NEAR(belief.belief[0], 1.0, 1e-6);
  EXPECT_EQ(belief.belief[20], 0.0f);  // a wrong match far from all that moved
  // Without the memory nobody would be concerned.
  EXPECT_EQ(update(missed).belief[0], 0.0f);
}

TEST(MotionBelief, TheMemoryIsReadWhereThePointWas) {
  // Given a person that walked 100 px since, and rests now; the memory reaches 68 px.
  const MotionBelief memory = update(Frame().add(20, 100, 50, 2.0f, 2.0f));
  Frame resting = Frame().add(20, 200, 50, 2.0f, 0.0f);
  EXPECT_EQ(update(resting, memory).belief[0], 0.0f);
  resting.earlier_u.assign(20, 100.0f);
  EXPECT_NEAR(update(resting, memory).belief[0], 6.0 / 7.0, 1e-5);
  // What is lost is looked for where it is now; without matches, all are.
  resting.earlier_v.assign(20, kNaN);
  EXPECT_EQ(update(resting, memory).belief[0], 0.0f);
  resting.earlier_u.clear();
  resting.earlier_v.clear();
  EXPECT_EQ(update(resting, memory).belief[0], 0.0f);
}

TEST(MotionBelief, MuchMemoryWeighsNoMoreThanItsCap) {
  // Given 40 points of weight 0.9: 36 full votes, cut to 20, times 2 against 40 * 0.3
  const MotionBelief memory = update(Frame().add(40, 100, 50, 2.0f, 2.0f));
  EXPECT_NEAR(update(Frame().add(40, 100, 50, 2.0f, 0.0f), memory).belief[0], 40.0 / 52.0, 1e-5);
  MotionBeliefOptions without = test::fixedBeliefOptions();
  without.memory_gain = 0.0f;
  EXPECT_EQ(update(Frame().add(40, 100, 50, 2.0f, 0.0f), memory, without).belief[0], 0.0f);
}

TEST(MotionBelief, PointsOutOfRangeVoteAmongThemselves) {
  // Given a moving person before a wall that is too far to be measured
  Frame frame;
  frame.add(4, 100, 50, 2.0f, 2.0f);
  frame.add(100, 50, 0.0f, 0.1f).support(SurfaceSupport::kNone);
  frame.add(180, 50, 0.0f, 0.65f).support(SurfaceSupport::kNone);
  const MotionBelief belief = update(frame);
  EXPECT_EQ(belief.depth[4], 9.0f);
  EXPECT_NEAR(belief.belief[0], 1.0, 1e-6);
  // Votes 0 with weight 0.3, and 0.5 with 0.3 + 0.7 * 0.5 = 0.65; sigma apart
  EXPECT_NEAR(belief.belief[4], 0.586182 * 0.325 / (0.3 + 0.586182 * 0.65), 1e-5);
}

TEST(MotionBelief, AMeasuredSurfaceAsDeepAsTheUnmeasuredVotesWithThem) {
  Frame frame;
  frame.add(100, 50, 0.0f, 0.1f).support(SurfaceSupport::kNone);
  frame.add(100, 50, 9.0f, 2.0f);
  const MotionBelief belief = update(frame);
  EXPECT_NEAR(belief.belief[0], 1.0 / 1.3, 1e-6);
  EXPECT_NEAR(belief.belief[1], 1.0 / 1.3, 1e-6);
}

TEST(MotionBelief, OnAnUnknownSurfaceNothingIsKnown) {
  Frame frame;
  frame.add(100, 50, 2.0f, 0.1f)
      .add(100, 50, 0.0f, 3.0f)
      .support(SurfaceSupport::kBeside)
      .dragged();
  const MotionBelief belief = update(frame);
  EXPECT_EQ(belief.belief[0], 0.0f);
  EXPECT_TRUE(std::isnan(belief.belief[1]));
  EXPECT_EQ(belief.weight[1], 0.0f);
}

TEST(MotionBelief, InferredDepthsCountLess) {
  for (const SurfaceSupport support : {SurfaceSupport::kEnclosed, SurfaceSupport::kBehind}) {
    Frame frame;
    frame.add(100, 50, 2.0f, 0.1f).add(100, 50, 2.0f, 3.0f).support(support);
    EXPECT_NEAR(update(frame).belief[0], 0.3 / (0.3 + 0.3), 1e-6) << toString(support);
  }
}

TEST(MotionBelief, WithoutVotesNothingIsKnown) {
  EXPECT_EQ(update(Frame()).size(), 0U);
  const MotionBelief belief = update(Frame().add(100, 50, 2.0f, kNaN).add(110, 50, 2.0f, kNaN));
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_TRUE(std::isnan(belief.belief[i]));
    EXPECT_EQ(belief.weight[i], 0.0f);
  }
  // Votes of 0.3 leave a point judged, half of that does not.
  MotionBeliefOptions options = test::fixedBeliefOptions();
  options.quiet_weight = 0.19f;
  EXPECT_TRUE(std::isnan(update(Frame().add(100, 50, 2.0f, 0.1f), {}, options).belief[0]));
  options.quiet_weight = 0.21f;
  EXPECT_EQ(update(Frame().add(100, 50, 2.0f, 0.1f), {}, options).belief[0], 0.0f);
}

TEST(MotionBelief, APointWithoutADistanceIsJudgedByItsNeighbours) {
  const MotionBelief belief = update(Frame().add(100, 50, 2.0f, 3.0f).add(110, 50, 2.0f, kNaN));
  EXPECT_NEAR(belief.belief[1], 1.0, 1e-6);
}

TEST(MotionBelief, PointsWithoutAPixelTakeNoPart) {
  // Given a frame with a point that is nowhere, and the next
  for (const float nowhere : {kNaN, kInfinity}) {
    Frame frame;
    frame.add(100, 50, 2.0f, 2.0f).add(nowhere, 50, 2.0f, 2.0f).add(100, nowhere, 2.0f, 2.0f);
    frame.support(SurfaceSupport::kNone);
    frame.in_box = {1, 0, 1};
    const MotionBelief belief = update(frame);
    EXPECT_NEAR(belief.belief[0], 1.0, 1e-6);
    EXPECT_NEAR(belief.weight[0], 0.9 / 20.0, 1e-6);
    for (const std::size_t i : {1U, 2U}) {
      EXPECT_TRUE(std::isnan(belief.belief[i]));
      EXPECT_EQ(belief.weight[i], 0.0f);
    }
    // Then a memory with such a point is the memory of the others.
    MotionBelief spoilt = belief;
    spoilt.belief[1] = 1.0f;
    spoilt.weight[1] = 1.0f;
    spoilt.depth[0] = kInfinity;
    EXPECT_EQ(update(Frame().add(100, 50, 2.0f, 0.1f), spoilt).belief[0], 0.0f) << nowhere;
    spoilt.depth[0] = 2.0f;
    const double memory = 2.0 * 0.045;
    EXPECT_NEAR(update(Frame().add(100, 50, 2.0f, 0.1f), spoilt).belief[0], memory / (memory + 0.3),
                1e-5);
  }
}

}  // namespace
}  // namespace hmcdyn

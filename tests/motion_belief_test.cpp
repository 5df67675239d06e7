// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <hmcdyn/motion_belief.hpp>

#include "invalid_argument.hpp"

namespace hmcdyn {
namespace {

/// Points of a frame, each told in one line.
struct Scene {
  KeyPoints points;
  std::vector<float> distance;
  std::vector<PointLabel> label;
  std::vector<std::uint8_t> in_box;
  std::vector<SurfaceSupport> support;
  std::vector<std::uint8_t> is_dragged;

  std::size_t add(float u, float v, float depth, float d, bool boxed = true,
                  PointLabel verdict = PointLabel::kSuspect, bool dragged = false,
                  SurfaceSupport known = SurfaceSupport::kMeasured) {
    points.push_back(u, v, depth);
    distance.push_back(d);
    label.push_back(verdict);
    in_box.push_back(boxed ? 1 : 0);
    support.push_back(known);
    is_dragged.push_back(dragged ? 1 : 0);
    return points.size() - 1;
  }

  MotionBelief vote(const MotionBelief& memory = {},
                    const MotionBeliefOptions& options = {}) const {
    MotionBeliefWorkspace workspace;
    workspace.surface.depth = points.depth;
    workspace.surface.support = support;
    workspace.surface.is_dragged = is_dragged;
    const MotionBeliefInput input{points.view(), distance, label, in_box, {}, {}};
    return updateMotionBelief(input, memory, options, workspace);
  }
};

/// A grid of points on one surface.
void addSurface(Scene& scene, float u, float v, float depth, float d, int side, float step,
                bool boxed = true) {
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      scene.add(u + step * static_cast<float>(column), v + step * static_cast<float>(row), depth, d,
                boxed);
    }
  }
}

TEST(MotionBelief, TwoPointsVoteByTheKernelsClosedForm) {
  // Given a point that moves (votes 1 with weight 1) and one at rest (0 with weight 0.3), 80 px
  // apart on one surface: q = (80 / 80)^2 = 1, kernel (1 - 1/8)^4
  Scene scene;
  const std::size_t moving = scene.add(100.0f, 100.0f, 2.0f, 3.0f);
  const std::size_t resting = scene.add(180.0f, 100.0f, 2.0f, 0.0f);
  const double kernel = std::pow(0.875, 4.0);
  // When they vote, then each belief is the weighted mean.
  const MotionBelief belief = scene.vote();
  EXPECT_NEAR(belief.belief[moving], 1.0 / (1.0 + 0.3 * kernel), 1e-6);
  EXPECT_NEAR(belief.belief[resting], kernel / (kernel + 0.3), 1e-6);
  // Weights: the sum over the cap of 20, decayed by 0.9.
  EXPECT_NEAR(belief.weight[moving], 0.9 * (1.0 + 0.3 * kernel) / 20.0, 1e-6);
}

TEST(MotionBelief, DepthSeparatesNeighbours) {
  // At 2.45 m depth_sigma = 0.03 + 0.02 * 2.45^2 = 0.15 m; 0.45 m are beyond 2.83 of it.
  Scene scene;
  scene.add(100.0f, 100.0f, 2.0f, 3.0f);
  const std::size_t wall = scene.add(101.0f, 100.0f, 2.45f, 0.0f);
  EXPECT_FLOAT_EQ(scene.vote().belief[wall], 0.0f);
}

TEST(MotionBelief, ADraggedCornerIsOutvotedByItsWall) {
  Scene scene;
  addSurface(scene, 100.0f, 100.0f, 3.0f, 0.1f, 4, 12.0f);
  const std::size_t corner = scene.add(95.0f, 118.0f, 3.0f, 6.0f, true, PointLabel::kDynamic, true);
  const MotionBelief belief = scene.vote();
  EXPECT_LT(belief.belief[corner], 0.1f);
  EXPECT_FLOAT_EQ(belief.weight[corner], 0.0f) << "what a corner at an edge believes is not kept";
}

TEST(MotionBelief, AStillArmMovesWithItsBody) {
  Scene scene;
  addSurface(scene, 100.0f, 100.0f, 2.0f, 3.0f, 4, 12.0f);
  const std::size_t arm = scene.add(150.0f, 120.0f, 2.05f, 0.1f);
  EXPECT_GT(scene.vote().belief[arm], 0.8f);
}

TEST(MotionBelief, APersonWhoPausesIsReleasedWhenTheOptionsSaySo) {
  // Given one point (a surface of one) that moved with a memory of full weight
  MotionBeliefOptions options;
  options.min_weight = 0.01f;
  Scene moving;
  moving.add(100.0f, 100.0f, 2.0f, 3.0f);
  MotionBelief memory = moving.vote({}, options);
  memory.weight[0] = 0.9f;
  Scene resting;
  resting.add(100.0f, 100.0f, 2.0f, 0.0f);
  // When it rests, then each frame b <- (2 w b) / (2 w + 0.3), w <- 0.9 (2 w + 0.3) / 20.
  double belief = 1.0;
  double weight = 0.9;
  int frames = 0;
  int expected = -1;
  for (int frame = 0; frame < 6; ++frame) {
    belief = 2.0 * weight * belief / (2.0 * weight + 0.3);
    weight = 0.9 * std::min(1.0, (2.0 * weight + 0.3) / 20.0);
    expected = expected < 0 && belief <= 0.6 ? frame : expected;
    memory = resting.vote(memory, options);
    EXPECT_NEAR(memory.belief[0], belief, 1e-4) << "frame " << frame;
    frames += memory.belief[0] > options.dynamic_belief ? 1 : 0;
  }
  EXPECT_EQ(frames, expected);
  EXPECT_GE(frames, 1) << "not trusted at once";
  EXPECT_LT(frames, 6) << "but in the end";
}

TEST(MotionBelief, AWallThatWasMisjudgedOnceRecovers) {
  Scene wrong;
  addSurface(wrong, 100.0f, 100.0f, 3.0f, 2.0f, 4, 12.0f);
  MotionBelief memory = wrong.vote();
  EXPECT_GT(memory.belief[0], 0.9f);
  Scene right;
  addSurface(right, 100.0f, 100.0f, 3.0f, 0.1f, 4, 12.0f);
  int frames = 0;
  while (memory.belief[0] > 0.6f && frames < 100) {
    memory = right.vote(memory);
    ++frames;
  }
  EXPECT_LE(frames, 15) << "half a second";
}

TEST(MotionBelief, AMissedDetectionIsBridgedByTheMemory) {
  Scene detected;
  addSurface(detected, 100.0f, 100.0f, 2.0f, 3.0f, 4, 12.0f);
  const MotionBelief memory = detected.vote();
  // The same points, but no box, and no distance for one of them
  Scene missed;
  addSurface(missed, 100.0f, 100.0f, 2.0f, 3.0f, 4, 12.0f, false);
  missed.distance[5] = kNaN;
  missed.label.assign(missed.label.size(), PointLabel::kStatic);
  const MotionBelief belief = missed.vote(memory);
  EXPECT_GT(belief.belief[5], 0.9f);
  // Without the memory they are background, as the paper has it.
  EXPECT_FLOAT_EQ(missed.vote().belief[5], 0.0f);
}

TEST(MotionBelief, PointsOutOfRangeVoteAmongThemselves) {
  Scene scene;
  for (int k = 0; k < 6; ++k) {
    scene.add(100.0f + 10.0f * static_cast<float>(k), 50.0f, 0.0f, 0.1f, true, PointLabel::kSuspect,
              false, SurfaceSupport::kNone);
  }
  const std::size_t odd = scene.add(125.0f, 55.0f, 0.0f, 4.0f, true, PointLabel::kDynamic, false,
                                    SurfaceSupport::kNone);
  addSurface(scene, 100.0f, 60.0f, 2.0f, 4.0f, 4, 10.0f);
  EXPECT_LT(scene.vote().belief[odd], 0.6f) << "the person's votes are no business of the wall's";
}

TEST(MotionBelief, WithoutVotesNothingIsBelieved) {
  Scene scene;
  const std::size_t alone = scene.add(100.0f, 100.0f, 2.0f, kNaN);
  const std::size_t unknown = scene.add(200.0f, 100.0f, 0.0f, 1.0f, true, PointLabel::kDynamic,
                                        true, SurfaceSupport::kBeside);
  const MotionBelief belief = scene.vote();
  EXPECT_TRUE(std::isnan(belief.belief[alone]));
  EXPECT_TRUE(std::isnan(belief.belief[unknown]));
  EXPECT_EQ(Scene().vote().size(), 0U);
}

TEST(MotionBelief, DoesNotDependOnTheOrderOrThePlace) {
  Scene scene;
  addSurface(scene, 100.0f, 100.0f, 2.0f, 3.0f, 3, 15.0f);
  addSurface(scene, 130.0f, 110.0f, 3.0f, 0.2f, 3, 15.0f);
  const MotionBelief belief = scene.vote();
  Scene reversed;
  const std::size_t n = scene.points.size();
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t i = n - 1 - k;
    reversed.add(scene.points.u[i] + 50.0f, scene.points.v[i] - 20.0f, scene.points.depth[i],
                 scene.distance[i]);
  }
  const MotionBelief other = reversed.vote();
  for (std::size_t i = 0; i < n; ++i) {
    EXPECT_NEAR(belief.belief[i], other.belief[n - 1 - i], 1e-5f) << "point " << i;
  }
}

TEST(MotionBelief, MistakesOfTheCallerAreNamed) {
  Scene scene;
  scene.add(1.0f, 1.0f, 1.0f, 1.0f);
  scene.in_box.clear();
  EXPECT_NE(test::invalidArgumentOf([&] { scene.vote(); }).find("0 flags"), std::string::npos);
  Scene fine;
  fine.add(1.0f, 1.0f, 1.0f, 1.0f);
  MotionBeliefOptions options;
  options.moving_distance = 0.2f;
  EXPECT_NE(test::invalidArgumentOf([&] { fine.vote({}, options); }).find("moving_distance is 0.2"),
            std::string::npos);
}

TEST(ApplyMotionBelief, TurnsBeliefsIntoLabelsAndWeights) {
  // Points: believed to move; kept suspect; called dynamic but at rest; the same at an edge;
  // unknown at an edge; unknown elsewhere; outside every box and at rest.
  MotionBelief belief;
  belief.u.assign(7, 0.0f);
  belief.v.assign(7, 0.0f);
  belief.belief = {0.9f, 0.25f, 0.5f, 0.1f, kNaN, kNaN, 0.0f};
  FilterStageResult stage;
  stage.label = {PointLabel::kSuspect, PointLabel::kSuspect, PointLabel::kDynamic,
                 PointLabel::kDynamic, PointLabel::kDynamic, PointLabel::kDynamic,
                 PointLabel::kStatic};
  stage.weight = {0.8f, 0.8f, 0.0f, 0.0f, 0.0f, 0.0f, 1.0f};
  stage.frame.points = 7;
  const std::vector<std::uint8_t> in_box{1, 1, 1, 1, 1, 1, 0};
  const std::vector<std::uint8_t> dragged{0, 0, 0, 1, 1, 0, 0};
  const FilterStageResult result = applyMotionBelief(belief, in_box, dragged, stage);
  EXPECT_EQ(result.label, (std::vector<PointLabel>{PointLabel::kDynamic, PointLabel::kSuspect,
                                                   PointLabel::kSuspect, PointLabel::kSuspect,
                                                   PointLabel::kSuspect, PointLabel::kDynamic,
                                                   PointLabel::kStatic}));
  const std::vector<float> weights{0.0f, 0.8f * 0.75f, 0.5f, 0.0f, 0.0f, 0.0f, 1.0f};
  for (std::size_t i = 0; i < weights.size(); ++i) {
    EXPECT_FLOAT_EQ(result.weight[i], weights[i]) << "point " << i;
  }
  EXPECT_EQ(result.frame.dynamic, 2U);
  EXPECT_EQ(result.frame.suspect, 4U);
  EXPECT_THROW(applyMotionBelief(belief, {}, dragged, stage), std::invalid_argument);
}

}  // namespace
}  // namespace hmcdyn

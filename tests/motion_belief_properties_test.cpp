// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <hmcdyn/votes/motion_belief.hpp>

#include "belief_frame.hpp"
#include "constants.hpp"
#include "invalid_argument.hpp"
#include "random.hpp"

namespace hmcdyn {
namespace {

using test::kInfinity;

using Frame = test::BeliefFrame;
using test::update;

/// A frame drawn at random, the points in a given order and moved by (du, dv).
Frame drawn(const std::vector<int>& order, float du, float dv) {
  test::Random random(17);
  Frame all;
  for (std::size_t k = 0; k < order.size(); ++k) {
    all.add(random.uniformFloat(0, 640) + du, random.uniformFloat(0, 480) + dv,
            random.uniformFloat(1, 5), random.uniformFloat(0, 2));
    all.in_box.back() = random.chance(0.7) ? 1 : 0;
    if (random.chance(0.2)) {
      all.support(SurfaceSupport::kNone);
    } else if (random.chance(0.2)) {
      all.support(SurfaceSupport::kBehind).dragged();
    }
    if (random.chance(0.1)) {
      all.distance.back() = kNaN;
    }
  }
  Frame frame;
  for (const int index : order) {
    const auto i = static_cast<std::size_t>(index);
    frame.add(all.points.u[i], all.points.v[i], all.surface.depth[i], all.distance[i]);
    frame.surface.support.back() = all.surface.support[i];
    frame.surface.is_dragged.back() = all.surface.is_dragged[i];
    frame.in_box.back() = all.in_box[i];
  }
  return frame;
}

/// Two frames' beliefs, the first being the memory of the second.
MotionBelief beliefOf(const std::vector<int>& order, float du, float dv) {
  const Frame frame = drawn(order, du, dv);
  return update(frame, update(frame));
}

void expectNear(const MotionBelief& actual, const MotionBelief& expected,
                const std::vector<int>& order) {
  for (std::size_t k = 0; k < order.size(); ++k) {
    const auto i = static_cast<std::size_t>(order[k]);
    EXPECT_EQ(std::isnan(actual.belief[k]), std::isnan(expected.belief[i])) << "point " << i;
    if (!std::isnan(expected.belief[i])) {
      EXPECT_NEAR(actual.belief[k], expected.belief[i], 1e-4) << "point " << i;
      EXPECT_NEAR(actual.weight[k], expected.weight[i], 1e-4) << "point " << i;
    }
  }
}

class MotionBeliefProperties : public testing::Test {
 protected:
  MotionBeliefProperties() : order(300) { std::iota(order.begin(), order.end(), 0); }
  std::vector<int> order;
};

TEST_F(MotionBeliefProperties, TheOrderOfThePointsDoesNotMatter) {
  const MotionBelief expected = beliefOf(order, 0.0f, 0.0f);
  std::vector<int> shuffled = order;
  test::Random random(3);
  for (int k = static_cast<int>(order.size()) - 1; k > 0; --k) {
    std::swap(shuffled[static_cast<std::size_t>(k)],
              shuffled[static_cast<std::size_t>(random.integer(0, k))]);
  }
  expectNear(beliefOf(shuffled, 0.0f, 0.0f), expected, shuffled);
}

TEST_F(MotionBeliefProperties, TheFrameMayMoveInTheImage) {
  expectNear(beliefOf(order, 64.0f, -32.0f), beliefOf(order, 0.0f, 0.0f), order);
}

TEST_F(MotionBeliefProperties, BeliefsAndWeightsStayInRangeAndRepeatBitForBit) {
  const MotionBelief first = beliefOf(order, 0.0f, 0.0f);
  const MotionBelief second = beliefOf(order, 0.0f, 0.0f);
  for (std::size_t i = 0; i < order.size(); ++i) {
    EXPECT_FALSE(first.belief[i] < 0.0f || first.belief[i] > 1.0f + 1e-6f) << first.belief[i];
    EXPECT_TRUE(first.weight[i] >= 0.0f && first.weight[i] <= 1.0f) << first.weight[i];
    EXPECT_TRUE(first.belief[i] == second.belief[i] ||
                (std::isnan(first.belief[i]) && std::isnan(second.belief[i])));
    EXPECT_EQ(first.weight[i], second.weight[i]);
  }
}

TEST_F(MotionBeliefProperties, AReusedWorkspaceChangesNothing) {
  const Frame large = drawn(order, 0.0f, 0.0f);
  const Frame small = Frame().add(100, 50, 2.0f, 2.0f).add(180, 50, 2.0f, 0.1f);
  const MotionBelief memory = update(large);
  MotionBeliefWorkspace workspace;
  for (const Frame* frame : {&large, &small, &large}) {
    workspace.surface = frame->surface;
    const MotionBelief reused =
        updateMotionBelief(frame->input(), memory, test::fixedBeliefOptions(), workspace);
    const MotionBelief fresh = update(*frame, memory);
    for (std::size_t i = 0; i < fresh.size(); ++i) {
      EXPECT_TRUE(reused.belief[i] == fresh.belief[i] ||
                  (std::isnan(reused.belief[i]) && std::isnan(fresh.belief[i])));
      EXPECT_EQ(reused.weight[i], fresh.weight[i]);
    }
  }
}

TEST_F(MotionBeliefProperties, PointsThatAreNotOpenVoteAllTheSame) {
  const Frame frame = drawn(order, 0.0f, 0.0f);
  const MotionBelief memory = update(frame);
  const MotionBelief all = update(frame, memory);
  std::vector<std::uint8_t> is_open(order.size());
  for (std::size_t i = 0; i < is_open.size(); ++i) {
    is_open[i] = i % 3 == 0 ? 1 : 0;
  }
  MotionBeliefInput input = frame.input();
  input.is_open = is_open;
  MotionBeliefWorkspace workspace;
  workspace.surface = frame.surface;
  const MotionBelief some =
      updateMotionBelief(input, memory, test::fixedBeliefOptions(), workspace);
  EXPECT_EQ(some.depth, all.depth);
  for (std::size_t i = 0; i < is_open.size(); ++i) {
    if (is_open[i] == 0) {
      EXPECT_TRUE(std::isnan(some.belief[i])) << i;
      EXPECT_EQ(some.weight[i], 0.0f) << i;
    } else {
      EXPECT_TRUE(some.belief[i] == all.belief[i] ||
                  (std::isnan(some.belief[i]) && std::isnan(all.belief[i])))
          << i;
      EXPECT_EQ(some.weight[i], all.weight[i]) << i;
    }
  }
}

TEST(MotionBelief, FlagsOfOpenPointsAreCounted) {
  const Frame frame = Frame().add(100, 50, 2.0f, 2.0f);
  const std::vector<std::uint8_t> is_open(2, 1);
  MotionBeliefInput input = frame.input();
  input.is_open = is_open;
  MotionBeliefWorkspace workspace;
  workspace.surface = frame.surface;
  EXPECT_EQ(
      test::invalidArgumentOf(
          [&] { updateMotionBelief(input, {}, test::fixedBeliefOptions(), workspace); }),
      "updateMotionBelief: is_open has 2 elements; expected one for each of the 1 key points, "
      "or none");
}

TEST(MotionBelief, UnequalArraysAreNamed) {
  const auto message = [](auto change) {
    Frame frame = Frame().add(100, 50, 2.0f, 2.0f);
    MotionBelief memory = update(frame);
    change(frame, memory);
    return test::invalidArgumentOf([&] { update(frame, memory); });
  };
  using Memory = MotionBelief;
  EXPECT_EQ(message([](Frame& f, Memory&) { f.distance.clear(); }),
            "updateMotionBelief: 1 key points, but 0 distances, 1 labels, 1 flags, 1 earlier "
            "columns, 1 rows; expected equal sizes (no earlier pixels: 0)");
  EXPECT_EQ(message([](Frame& f, Memory&) { f.earlier_v.clear(); }),
            "updateMotionBelief: 1 key points, but 1 distances, 1 labels, 1 flags, 1 earlier "
            "columns, 0 rows; expected equal sizes (no earlier pixels: 0)");
  EXPECT_EQ(message([](Frame& f, Memory&) { f.surface.is_dragged.clear(); }),
            "updateMotionBelief: workspace.surface has 1 points; expected surfaceDepths() of "
            "these 1");
  EXPECT_EQ(message([](Frame&, Memory& m) { m.weight.clear(); }),
            "updateMotionBelief: memory: u has 1 elements, v 1, depth 1, belief 1, weight 0; "
            "expected equal sizes");
  EXPECT_EQ(message([](Frame& f, Memory&) { f.points.v.clear(); }),
            "key points: u has 1 elements, v 0, depth 1; expected equal sizes");
  EXPECT_EQ(message([](Frame&, Memory&) {}), "nothing thrown");
}

TEST(MotionBelief, OptionsOutOfRangeAreNamed) {
  const auto message = [](auto change) {
    MotionBeliefOptions options = test::fixedBeliefOptions();
    change(options);
    return test::invalidArgumentOf([&] { update(Frame(), {}, options); });
  };
  using Options = MotionBeliefOptions;
  EXPECT_EQ(message([](Options& o) { o.sigma = 0.0f; }),
            "MotionBeliefOptions::sigma is 0.000000; expected a finite value > 0");
  EXPECT_EQ(message([](Options& o) { o.memory_sigma = kInfinity; }),
            "MotionBeliefOptions::memory_sigma is inf; expected a finite value > 0");
  EXPECT_EQ(message([](Options& o) { o.depth_sigma_floor = 0.0f; }),
            "MotionBeliefOptions::depth_sigma_floor is 0.000000; expected a finite value > 0");
  EXPECT_EQ(message([](Options& o) { o.depth_sigma_quadratic = kInfinity; }),
            "MotionBeliefOptions::depth_sigma_quadratic is inf; expected a finite value >= 0 "
            "(1/m)");
  EXPECT_EQ(message([](Options& o) { o.unmeasured_depth = kNaN; }),
            "MotionBeliefOptions::unmeasured_depth is nan; expected a finite value > 0");
  EXPECT_EQ(message([](Options& o) { o.min_weight = 0.0f; }),
            "MotionBeliefOptions::min_weight is 0.000000; expected a finite value > 0");
  EXPECT_EQ(message([](Options& o) { o.weight_cap = -1.0f; }),
            "MotionBeliefOptions::weight_cap is -1.000000; expected a finite value > 0");
  EXPECT_EQ(message([](Options& o) { o.still_distance = -0.1f; }),
            "MotionBeliefOptions::still_distance is -0.100000; expected a value >= 0 (px)");
  EXPECT_EQ(message([](Options& o) { o.moving_distance = 0.3f; }),
            "MotionBeliefOptions::moving_distance is 0.300000; expected a finite value above "
            "still_distance (px)");
  EXPECT_EQ(message([](Options& o) { o.memory_gain = -1.0f; }),
            "MotionBeliefOptions::memory_gain is -1.000000; expected a finite value >= 0");
  EXPECT_EQ(message([](Options& o) { o.dynamic_evidence = 1.5f; }),
            "MotionBeliefOptions::dynamic_evidence is 1.500000; expected a value in [0, 1]");
  EXPECT_EQ(message([](Options& o) { o.quiet_weight = -0.5f; }),
            "MotionBeliefOptions::quiet_weight is -0.500000; expected a value in [0, 1]");
  EXPECT_EQ(message([](Options& o) { o.inferred_weight = kNaN; }),
            "MotionBeliefOptions::inferred_weight is nan; expected a value in [0, 1]");
  EXPECT_EQ(message([](Options& o) { o.dragged_weight = 2.0f; }),
            "MotionBeliefOptions::dragged_weight is 2.000000; expected a value in [0, 1]");
  EXPECT_EQ(message([](Options& o) { o.memory_decay = 1.1f; }),
            "MotionBeliefOptions::memory_decay is 1.100000; expected a value in [0, 1]");
  EXPECT_EQ(message([](Options& o) { o.dynamic_belief = -1.0f; }),
            "MotionBeliefOptions::dynamic_belief is -1.000000; expected a value in [0, 1]");
  EXPECT_EQ(message([](Options& o) { o.certain_weight = 1.5f; }),
            "MotionBeliefOptions::certain_weight is 1.500000; expected a value in [0, 1]");
  EXPECT_EQ(message([](Options&) {}), "nothing thrown");
}

}  // namespace
}  // namespace hmcdyn

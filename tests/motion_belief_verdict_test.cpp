// SPDX-License-Identifier: BSD-3-Clause
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <hmcdyn/votes/belief_verdict.hpp>
#include <hmcdyn/votes/motion_belief.hpp>

#include "invalid_argument.hpp"

namespace hmcdyn {
namespace {

constexpr auto kStatic = PointLabel::kStatic;
constexpr auto kSuspect = PointLabel::kSuspect;
constexpr auto kDynamic = PointLabel::kDynamic;
constexpr auto kUnmatched = PointLabel::kUnmatched;

MotionBeliefOptions fixedOptions() {
  MotionBeliefOptions options;
  options.dynamic_belief = 0.6f;
  return options;
}

BeliefVerdictOptions fixedVerdict() {
  BeliefVerdictOptions options;
  options.dragged_weight = 0.1f;
  return options;
}

struct Judged {
  PointLabel label;
  float weight;
};

FilterStageResult stageOf(const std::vector<Judged>& points) {
  FilterStageResult stage;
  for (const Judged& point : points) {
    stage.label.push_back(point.label);
    stage.weight.push_back(point.weight);
    stage.cluster.push_back(kNoise);
  }
  return stage;
}

MotionBelief beliefOf(const std::vector<float>& moving) {
  MotionBelief belief;
  belief.belief = moving;
  belief.u = belief.v = belief.depth = belief.weight = std::vector<float>(moving.size(), 1.0f);
  return belief;
}

Judged judge(float moving, bool is_dragged, const Judged& before) {
  const std::vector<std::uint8_t> dragged{static_cast<std::uint8_t>(is_dragged ? 1 : 0)};
  const FilterStageResult stage = applyMotionBelief(beliefOf({moving}), dragged, stageOf({before}),
                                                    fixedOptions(), fixedVerdict());
  return {stage.label[0], stage.weight[0]};
}

void expectJudged(const Judged& actual, PointLabel label, float weight) {
  EXPECT_STREQ(toString(actual.label), toString(label));
  EXPECT_FLOAT_EQ(actual.weight, weight);
}

TEST(BeliefVerdict, WhatIsBelievedToMoveIsDynamic) {
  for (const PointLabel label : {kStatic, kSuspect, kDynamic, kUnmatched}) {
    expectJudged(judge(0.61f, false, {label, 0.7f}), kDynamic, 0.0f);
    expectJudged(judge(1.0f, true, {label, 0.7f}), kDynamic, 0.0f);
  }
}

TEST(BeliefVerdict, WhatIsBelievedAtRestIsKept) {
  expectJudged(judge(0.6f, false, {kStatic, 1.0f}), kStatic, 1.0f);
  expectJudged(judge(0.25f, false, {kSuspect, 0.8f}), kSuspect, 0.6f);
  expectJudged(judge(0.25f, false, {kDynamic, 0.0f}), kSuspect, 0.75f);
  expectJudged(judge(0.25f, false, {kUnmatched, 0.4f}), kSuspect, 0.75f);
}

TEST(BeliefVerdict, WhatMayHaveBeenDraggedCountsLittle) {
  expectJudged(judge(0.25f, true, {kStatic, 1.0f}), kStatic, 1.0f);
  for (const PointLabel label : {kSuspect, kDynamic, kUnmatched}) {
    expectJudged(judge(0.25f, true, {label, 0.8f}), kSuspect, 0.1f);
    expectJudged(judge(kNaN, true, {label, 0.8f}), kSuspect, 0.1f);
  }
}

TEST(BeliefVerdict, TheUnjudgedKeepWhatWasSaid) {
  for (const PointLabel label : {kStatic, kSuspect, kDynamic, kUnmatched}) {
    expectJudged(judge(kNaN, false, {label, 0.4f}), label, 0.4f);
  }
  expectJudged(judge(kNaN, true, {kStatic, 1.0f}), kStatic, 1.0f);
}

TEST(BeliefVerdict, TheFrameIsCountedAgain) {
  // Given a stage that counted otherwise
  FilterStageResult stage = stageOf(
      {{kStatic, 1.0f}, {kStatic, 1.0f}, {kDynamic, 0.0f}, {kUnmatched, 0.0f}, {kDynamic, 0.0f}});
  stage.frame.points = 5;
  stage.frame.dynamic = 2;
  stage.frame.unmatched = 1;
  stage.frame.dynamic_boxes = 1;
  const std::vector<std::uint8_t> flags(5, 0);
  const FilterStageResult result =
      applyMotionBelief(beliefOf({0.0f, 0.9f, 0.1f, kNaN, 0.9f}), flags, std::move(stage),
                        fixedOptions(), fixedVerdict());
  EXPECT_EQ(result.frame.points, 5U);
  EXPECT_EQ(result.frame.dynamic, 2U);
  EXPECT_EQ(result.frame.suspect, 1U);
  EXPECT_EQ(result.frame.unmatched, 1U);
  EXPECT_EQ(result.frame.dynamic_boxes, 1U);  // a box's decision stays
}

TEST(BeliefVerdict, ErrorsNameTheArgument) {
  const std::vector<std::uint8_t> one{0};
  const auto message = [&](auto change) {
    MotionBelief belief = beliefOf({0.5f});
    FilterStageResult stage = stageOf({{kSuspect, 1.0f}});
    BeliefVerdictOptions verdict = fixedVerdict();
    change(belief, stage, verdict);
    return test::invalidArgumentOf(
        [&] { applyMotionBelief(belief, one, stage, fixedOptions(), verdict); });
  };
  using Belief = MotionBelief;
  using Stage = FilterStageResult;
  using Verdict = BeliefVerdictOptions;
  EXPECT_EQ(
      message([](Belief& b, Stage&, Verdict&) { b = beliefOf({}); }),
      "applyMotionBelief: 1 labels, but 1 weights, 0 beliefs and 1 flags; expected equal sizes");
  EXPECT_EQ(
      message([](Belief&, Stage& s, Verdict&) { s.weight.clear(); }),
      "applyMotionBelief: 1 labels, but 0 weights, 1 beliefs and 1 flags; expected equal sizes");
  EXPECT_EQ(message([](Belief& b, Stage&, Verdict&) { b.belief.clear(); }),
            "applyMotionBelief: belief: u has 1 elements, v 1, depth 1, belief 0, weight 1; "
            "expected equal sizes");
  EXPECT_EQ(
      message([](Belief& b, Stage&, Verdict&) { b.belief[0] = 1.5f; }),
      "applyMotionBelief: belief: point 0 has belief 1.500000, weight 1.000000; expected both "
      "in [0, 1], or a belief of NaN");
  EXPECT_EQ(
      message([](Belief& b, Stage&, Verdict&) { b.weight[0] = kNaN; }),
      "applyMotionBelief: belief: point 0 has belief 0.500000, weight nan; expected both in [0, "
      "1], or a belief of NaN");
  EXPECT_EQ(message([](Belief&, Stage&, Verdict& v) { v.dragged_weight = 1.5f; }),
            "BeliefVerdictOptions::dragged_weight is 1.500000; expected a weight in [0, 1]");
  EXPECT_EQ(message([](Belief&, Stage&, Verdict&) {}), "nothing thrown");
}

}  // namespace
}  // namespace hmcdyn

// SPDX-License-Identifier: BSD-3-Clause
// Which points filterDynamicFeatures follows, and when it forms beliefs.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <hmcdyn/dynamic_feature_filter.hpp>

#include "filter_options.hpp"
#include "invalid_argument.hpp"
#include "layered_scene.hpp"

namespace hmcdyn {
namespace {

using test::LayeredScene;

DynamicFeatureFilterOptions beliefOptions() {
  DynamicFeatureFilterOptions options;
  options.flow.window = 11;
  options.flow.max_level = 1;
  options.flow.guess_max_level = 1;
  options.flow.max_iterations = 30;
  options.flow.max_difference = 12.0f;
  options.flow_margin = 20.0f;
  options.flow_in_boxes = 100;
  options.flow_background = 120;
  options.two_view.min_background_matches = 60;
  options.two_view.min_background_cells = 5;
  options.use_belief = true;
  options.stage = test::fixedStageOptions(FilterRule::kHmc);
  options.max_median_distance = 0.5f;
  return options;
}

/// A frame of the scene with its depth image, and earlier ones.
struct BelievedClip {
  explicit BelievedClip(const std::vector<int>& frames_ago,
                        const DynamicFeatureFilterOptions& with = beliefOptions(),
                        const Eigen::Vector2d& thing_step = {1.0, -3.0})
      : scene(LayeredScene::kUsualStep, thing_step),
        options(with),
        points(LayeredScene::keyPoints()),
        boxes{LayeredScene::boxOfThing()},
        current(buildFlowPyramid(scene.grayOf(0), options.flow)),
        depth(scene.depthOf(0)) {
    for (const int frames : frames_ago) {
      pyramids.push_back(buildFlowPyramid(scene.grayOf(frames), options.flow));
      ages.push_back(frames / 30.0);
    }
  }

  DynamicFeatureFilterResult run(const MotionBelief* memory = nullptr) const {
    std::vector<EarlierFrame> earlier;
    for (std::size_t k = 0; k < pyramids.size(); ++k) {
      earlier.emplace_back();
      earlier.back().pyramid = &pyramids[k];
      earlier.back().age = ages[k];
    }
    DynamicFeatureFilterInput input;
    input.pyramid = &current;
    input.points = points.view();
    input.regions = boxes;
    input.earlier = earlier;
    input.memory = memory;
    if (!depth.empty()) {
      input.depth = {depth.ptr<float>(), depth.cols, depth.rows, depth.step1()};
    }
    DynamicFeatureFilterWorkspace workspace;
    return filterDynamicFeatures(input, options, workspace);
  }

  bool onThing(std::size_t i) const { return LayeredScene::isThing(points.u[i], points.v[i]); }
  bool inBox(std::size_t i, float margin) const {
    const DetectionBox& box = boxes.at(0);
    return points.u[i] >= box.x_min - margin && points.u[i] <= box.x_max + margin &&
           points.v[i] >= box.y_min - margin && points.v[i] <= box.y_max + margin;
  }

  LayeredScene scene;
  DynamicFeatureFilterOptions options;
  KeyPoints points;
  std::vector<DetectionBox> boxes;
  FlowPyramid current;
  cv::Mat depth;
  std::vector<FlowPyramid> pyramids;
  std::vector<double> ages;
};

std::size_t measured(const std::vector<float>& distance) {
  return static_cast<std::size_t>(
      std::count_if(distance.begin(), distance.end(), [](float d) { return !std::isnan(d); }));
}

TEST(DynamicFeatureFilterBelief, WithoutBoxesAndMemoryNothingIsFollowed) {
  BelievedClip clip({1});
  clip.boxes.clear();
  for (const bool use_belief : {true, false}) {
    clip.options.use_belief = use_belief;
    const DynamicFeatureFilterResult result = clip.run();
    EXPECT_TRUE(result.earlier.empty());
    EXPECT_EQ(measured(result.distance), 0U);
    EXPECT_EQ(result.distance.size(), clip.points.size());
    EXPECT_EQ(result.stage.label, std::vector<PointLabel>(clip.points.size(), PointLabel::kStatic));
    EXPECT_EQ(result.stage.weight, std::vector<float>(clip.points.size(), 1.0f));
  }
}

TEST(DynamicFeatureFilterBelief, NoBackgroundBudgetFollowsAllEvenWithoutBoxes) {
  BelievedClip clip({1});
  clip.boxes.clear();
  clip.options.flow_background = 0;
  const DynamicFeatureFilterResult result = clip.run();
  ASSERT_EQ(result.earlier.size(), 1U);
  EXPECT_TRUE(result.earlier[0].used);
  EXPECT_EQ(measured(result.distance), clip.points.size());
}

TEST(DynamicFeatureFilterBelief, WhatMovedBeforeIsFollowedWithoutABox) {
  // Given the thing's belief of a frame with a box, and a frame where the detector misses it
  BelievedClip clip({1});
  const MotionBelief memory = clip.run().belief;
  clip.boxes.clear();
  const DynamicFeatureFilterResult bridged = clip.run(&memory);
  EXPECT_EQ(bridged.earlier.size(), 1U);
  for (std::size_t i = 0; i < clip.points.size(); ++i) {
    EXPECT_EQ(bridged.stage.label[i] == PointLabel::kDynamic, clip.onThing(i))
        << clip.points.u[i] << ", " << clip.points.v[i];
  }
  // A memory of nothing that moves asks for no flow.
  MotionBelief at_rest = memory;
  std::fill(at_rest.belief.begin(), at_rest.belief.end(), 0.0f);
  EXPECT_TRUE(clip.run(&at_rest).earlier.empty());
}

TEST(DynamicFeatureFilterBelief, ACrowdThatFillsTheImageIsNotTakenForTheWorld) {
  // Given more points on the thing than on the walls, and a belief of a frame that shows both
  BelievedClip clip({1});
  clip.options.flow_in_boxes = 0;
  clip.options.two_view.min_homography_share = 0.4f;
  const MotionBelief memory = clip.run().belief;
  KeyPoints few;
  std::size_t on_thing = 0;
  std::size_t on_walls = 0;
  for (std::size_t i = 0; i < clip.points.size(); ++i) {
    const bool thing = clip.onThing(i);
    if (thing || i % 13 == 0) {
      few.push_back(clip.points.u[i], clip.points.v[i], clip.points.depth[i]);
      on_thing += thing ? 1 : 0;
      on_walls += thing ? 0 : 1;
    }
  }
  ASSERT_GT(on_thing, on_walls + on_walls / 4);
  ASSERT_GT(on_walls, 65U);
  clip.points = few;
  // When boxes leave no background
  clip.boxes = {{-10.0f, -10.0f, 400.0f, 300.0f, kPersonClassId, 1.0f}};

  // Then what is known to move does not say how the camera moves.
  const auto dynamicOf = [&](const DynamicFeatureFilterResult& result, bool thing) {
    std::size_t dynamic = 0;
    for (std::size_t i = 0; i < clip.points.size(); ++i) {
      dynamic += clip.onThing(i) == thing && result.stage.label[i] == PointLabel::kDynamic ? 1 : 0;
    }
    return dynamic;
  };
  const DynamicFeatureFilterResult remembering = clip.run(&memory);
  EXPECT_EQ(remembering.earlier.at(0).motion.source, MatchSource::kAtRest);
  EXPECT_LE(remembering.earlier.at(0).motion.matches, on_walls);
  EXPECT_EQ(dynamicOf(remembering, true), on_thing);
  EXPECT_EQ(dynamicOf(remembering, false), 0U);
  // Without a memory the many are the world, and the walls move.
  const DynamicFeatureFilterResult forgetful = clip.run();
  EXPECT_EQ(forgetful.earlier.at(0).motion.source, MatchSource::kAll);
  EXPECT_LT(dynamicOf(forgetful, true), on_thing / 2);
}

TEST(DynamicFeatureFilterBelief, EnoughBackgroundNeedsNoMemory) {
  const BelievedClip clip({1});
  const MotionBelief memory = clip.run().belief;
  const DynamicFeatureFilterResult result = clip.run(&memory);
  EXPECT_EQ(result.earlier.at(0).motion.source, MatchSource::kBackground);
}

TEST(DynamicFeatureFilterBelief, OnlyTheBudgetIsFollowedAndTheOthersAreJudged) {
  const BelievedClip clip({1});
  const DynamicFeatureFilterResult result = clip.run();
  std::size_t in_box = 0;
  std::size_t background = 0;
  for (std::size_t i = 0; i < clip.points.size(); ++i) {
    if (!std::isnan(result.earlier.at(0).flow.u[i])) {
      (clip.inBox(i, 20.0f) ? in_box : background) += 1;
    }
  }
  EXPECT_LE(in_box, 100U);
  EXPECT_GE(in_box, 95U);  // some may be lost
  EXPECT_LE(background, 120U);
  EXPECT_GE(background, 115U);

  // Then the followed ones speak for the others, too.
  std::size_t unfollowed_things = 0;
  for (std::size_t i = 0; i < clip.points.size(); ++i) {
    EXPECT_EQ(result.stage.label[i] == PointLabel::kDynamic, clip.onThing(i))
        << clip.points.u[i] << ", " << clip.points.v[i] << ": " << result.belief.belief[i];
    unfollowed_things += clip.onThing(i) && std::isnan(result.distance[i]) ? 1 : 0;
  }
  EXPECT_GT(unfollowed_things, 20U);
  EXPECT_EQ(result.stage.frame.points, clip.points.size());
  EXPECT_EQ(result.stage.frame.dynamic_boxes, 1U);
}

TEST(DynamicFeatureFilterBelief, TheFollowedBackgroundIsSpreadOverTheImage) {
  // Given a grid of 12 x 12 cells, of which those with background points beyond the margin
  const BelievedClip clip({1});
  const DynamicFeatureFilterResult result = clip.run();
  const auto cell = [&](std::size_t i) {
    return static_cast<std::size_t>(clip.points.v[i] / LayeredScene::kHeight * 12) * 12 +
           static_cast<std::size_t>(clip.points.u[i] / LayeredScene::kWidth * 12);
  };
  std::vector<int> there(144, 0);
  std::vector<int> followed(144, 0);
  for (std::size_t i = 0; i < clip.points.size(); ++i) {
    if (!clip.inBox(i, 20.0f)) {
      ++there[cell(i)];
      followed[cell(i)] += std::isnan(result.earlier.at(0).flow.u[i]) ? 0 : 1;
    }
  }
  // Then every one of them has some, as far as the budget goes.
  const auto cells = std::count_if(there.begin(), there.end(), [](int count) { return count > 0; });
  const auto reached =
      std::count_if(followed.begin(), followed.end(), [](int count) { return count > 0; });
  ASSERT_LE(cells, 120);
  EXPECT_GE(reached, cells - 3);  // a match may be lost
}

TEST(DynamicFeatureFilterBelief, WithoutBeliefsEveryPointInABoxIsFollowed) {
  BelievedClip clip({1});
  clip.options.use_belief = false;
  const DynamicFeatureFilterResult result = clip.run();
  std::size_t in_box = 0;
  for (std::size_t i = 0; i < clip.points.size(); ++i) {
    if (clip.inBox(i, 20.0f)) {
      ++in_box;
      EXPECT_FALSE(std::isnan(result.distance[i])) << clip.points.u[i] << ", " << clip.points.v[i];
    }
  }
  EXPECT_GT(in_box, 200U);
  EXPECT_EQ(result.belief.size(), 0U);
}

TEST(DynamicFeatureFilterBelief, OnlyTheRuleHmcFormsBeliefs) {
  for (const FilterRule rule : kFilterRules) {
    BelievedClip clip({1});
    clip.options.stage = test::fixedStageOptions(rule);
    const DynamicFeatureFilterResult with_depth = clip.run();
    EXPECT_EQ(with_depth.belief.size(), rule == FilterRule::kHmc ? clip.points.size() : 0U)
        << toString(rule);
    clip.depth = cv::Mat();
    EXPECT_EQ(clip.run().belief.size(), 0U) << toString(rule);
  }
}

/// Share of the thing's and the walls' points that were found where they were, against `frames`
/// ago.
double shareRight(const BelievedClip& clip, const FlowMatches& flow, int frames) {
  std::size_t right = 0;
  std::size_t followed = 0;
  for (std::size_t i = 0; i < clip.points.size(); ++i) {
    if (clip.onThing(i)) {
      continue;
    }
    const double shift = clip.scene.shiftOf(static_cast<double>(clip.points.depth[i]), frames);
    const double was = static_cast<double>(clip.points.u[i]) - shift;
    if (was > 12.0 && !LayeredScene::isThing(was, clip.points.v[i] - 3.0 * frames)) {
      ++followed;
      right += std::abs(static_cast<double>(flow.u[i]) - was) < 0.3 ? 1 : 0;
    }
  }
  return static_cast<double>(right) / static_cast<double>(followed);
}

TEST(DynamicFeatureFilterBelief, AgesProlongTheFlowToOlderFrames) {
  // Given a neighbour, and a frame 12 ago, when the lowest wall was 36 px away
  DynamicFeatureFilterOptions options = beliefOptions();
  options.flow_background = 0;
  options.flow_in_boxes = 0;
  BelievedClip clip({1, 12}, options, {1.0, -0.5});
  const double prolonged = shareRight(clip, clip.run().earlier.at(1).flow, 12);
  // When nothing says how old they are
  clip.ages.assign(2, 0.0);
  const double plain = shareRight(clip, clip.run().earlier.at(1).flow, 12);

  // Then the search does not reach as far.
  EXPECT_GT(prolonged, 0.8);
  EXPECT_LT(plain, prolonged - 0.3);
}

TEST(DynamicFeatureFilterBelief, InputOfAnotherSizeIsNamed) {
  BelievedClip clip({1});
  const auto message = [](const BelievedClip& of, const MotionBelief* memory = nullptr) {
    return test::invalidArgumentOf([&] { of.run(memory); });
  };
  MotionBelief unequal = clip.run().belief;
  unequal.depth.pop_back();
  EXPECT_NE(message(clip, &unequal).find("memory: u has"), std::string::npos);
  BelievedClip other = clip;
  other.depth = clip.depth.rowRange(0, 100);
  EXPECT_EQ(message(other),
            "filterDynamicFeatures: depth is 320 x 100 px; expected the image's 320 x 240");
  other = clip;
  other.options.flow_in_boxes = -1;
  EXPECT_EQ(message(other),
            "DynamicFeatureFilterOptions: flow_background is 120, flow_in_boxes -1, flow_margin "
            "20.000000; expected counts and a margin (px) >= 0");
  other = clip;
  other.options.flow_margin = kNaN;
  EXPECT_EQ(message(other),
            "DynamicFeatureFilterOptions: flow_background is 120, flow_in_boxes 100, flow_margin "
            "nan; expected counts and a margin (px) >= 0");
  EXPECT_EQ(message(clip), "nothing thrown");
}

}  // namespace
}  // namespace hmcdyn

// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <hmcdyn/filter_stage.hpp>

#include "filter_options.hpp"
#include "invalid_argument.hpp"
#include "random_frame.hpp"

namespace hmcdyn {
namespace {

using test::fixedStageOptions;
using test::Frame;
using L = PointLabel;

/// A person's box over x in [0, 100]: 6 points of the person at 2.0-2.2 m that move by 3 px, 4 of
/// the wall at 4 m that stand, and 4 points outside that stand.
Frame personBeforeWall() {
  Frame frame;
  const auto add = [&](float u, float depth, float distance) {
    frame.points.push_back(u, 50.0f, depth);
    frame.distance.push_back(distance);
  };
  for (int i = 0; i < 6; ++i) {
    add(static_cast<float>(10 * i), 2.0f + 0.04f * static_cast<float>(i), 3.0f);  // 0-5
  }
  for (int i = 6; i < 10; ++i) {
    add(static_cast<float>(10 * i), 4.0f, 0.1f);
  }
  for (int i = 0; i < 4; ++i) {
    add(200.0f + static_cast<float>(i), 4.0f, 0.1f);  // 10-13
  }
  frame.boxes = {{0.0f, 0.0f, 100.0f, 100.0f, kPersonClassId, 1.0f}};
  return frame;
}

TEST(FilterStage, PersonBeforeWall) {
  // Given
  const Frame frame = personBeforeWall();

  // When
  const FilterStageResult result = frame.filter(fixedStageOptions(FilterRule::kHmc));

  // Then the person goes, the wall in the box stays with eq. 7's weight, the rest counts fully.
  const double mean = 2.1;  // of 2.0, 2.04 ... 2.2
  double variance = 0.0;    // of all ten depths in the box about their mean, 2.86
  for (int i = 0; i < 6; ++i) {
    variance += std::pow(2.0 + 0.04 * i - 2.86, 2) / 10.0;
  }
  variance += 4.0 * std::pow(4.0 - 2.86, 2) / 10.0;
  const double weight = 1.0 - std::exp(-std::pow(4.0 - mean, 2) / (2.0 * variance));
  for (std::size_t i = 0; i < 14; ++i) {
    const L label = i < 6 ? L::kDynamic : i < 10 ? L::kSuspect : L::kStatic;
    EXPECT_EQ(result.label[i], label) << "point " << i;
    EXPECT_NEAR(result.weight[i], i < 6 ? 0.0 : i < 10 ? weight : 1.0, 1e-5) << "point " << i;
    EXPECT_EQ(result.cluster[i], i < 6 ? 0 : i < 10 ? 1 : kNoise) << "point " << i;
  }
  ASSERT_EQ(result.boxes.size(), 1U);
  EXPECT_EQ(result.boxes[0].strongest, 0);
  EXPECT_NEAR(result.boxes[0].anchor.depth, mean, 1e-5);
  EXPECT_NEAR(result.boxes[0].anchor.sigma, std::sqrt(variance), 1e-5);
  EXPECT_EQ(result.boxes[0].clusters.size(), 2U);
  EXPECT_EQ(result.frame.points, 14U);
  EXPECT_EQ(result.frame.measured, 14U);
  EXPECT_EQ(result.frame.boxes, 1U);
  EXPECT_EQ(result.frame.dynamic_boxes, 1U);
  EXPECT_EQ(result.frame.points_in_dynamic_boxes, 10U);
  EXPECT_EQ(result.frame.dynamic, 6U);
  EXPECT_EQ(result.frame.suspect, 4U);
  EXPECT_EQ(result.frame.unmatched, 0U);
  EXPECT_NEAR(result.frame.mean_distance, (6 * 3.0 + 8 * 0.1) / 14.0, 1e-5);
}

TEST(FilterStage, LostMatchesInADynamicBoxAreNeverStatic) {
  // Given a lost match at the person's depth, one at the wall's, one without depth, one outside.
  Frame frame = personBeforeWall();
  for (const float depth : {2.1f, 4.0f, 0.0f}) {
    frame.points.push_back(50.0f, 60.0f, depth);
    frame.distance.push_back(kNaN);
  }
  frame.points.push_back(300.0f, 60.0f, 2.1f);
  frame.distance.push_back(kNaN);

  // When
  FilterStageOptions options = fixedStageOptions(FilterRule::kHmc);
  const FilterStageResult placed = frame.filter(options);
  options.cluster_filter.place_unmatched_by_depth = false;
  const FilterStageResult unplaced = frame.filter(options);

  // Then
  EXPECT_EQ(placed.label[14], L::kDynamic);
  EXPECT_EQ(placed.label[15], L::kUnmatched);
  EXPECT_EQ(placed.label[16], L::kUnmatched);
  EXPECT_EQ(placed.label[17], L::kStatic);
  EXPECT_EQ(placed.weight[14], 0.0f);
  EXPECT_EQ(placed.weight[15], placed.weight[6]);
  EXPECT_EQ(placed.weight[16], 0.25f);  // WeightOptions::without_depth
  EXPECT_EQ(placed.weight[17], 1.0f);
  EXPECT_EQ(placed.frame.unmatched, 2U);
  EXPECT_EQ(placed.frame.measured, 14U);
  EXPECT_EQ(unplaced.label[14], L::kUnmatched);
  EXPECT_EQ(unplaced.frame.unmatched, 3U);
}

TEST(FilterStage, WithoutAnAnchorTheOptionWeighs) {
  // Given a person of 4 points, fewer than an anchor needs, and more than 10 % of the box.
  Frame frame = personBeforeWall();
  frame.boxes[0].x_min = 15.0f;
  const FilterStageResult result = frame.filter(fixedStageOptions(FilterRule::kHmc));
  ASSERT_TRUE(result.boxes[0].verdict.is_dynamic);
  EXPECT_EQ(result.boxes[0].strongest, kNoise);
  EXPECT_TRUE(std::isnan(result.boxes[0].anchor.depth));
  for (std::size_t i = 0; i < 10; ++i) {
    const L expected = i < 2 ? L::kStatic : i < 6 ? L::kDynamic : L::kSuspect;
    EXPECT_EQ(result.label[i], expected) << "point " << i;
    EXPECT_EQ(result.weight[i], i < 2 ? 1.0f : i < 6 ? 0.0f : 0.75f) << "point " << i;
  }
}

TEST(FilterStage, APersonWhoStandsStillIsKept) {
  Frame frame = personBeforeWall();
  frame.distance.assign(frame.distance.size(), 0.2f);
  for (const FilterRule rule : {FilterRule::kHmc, FilterRule::kEpipolar}) {
    const FilterStageResult result = frame.filter(fixedStageOptions(rule));
    EXPECT_EQ(result.label, std::vector<L>(14, L::kStatic));
    EXPECT_EQ(result.weight, std::vector<float>(14, 1.0f));
    EXPECT_EQ(result.frame.dynamic_boxes, 0U);
  }
}

TEST(FilterStage, WithoutBoxesOrDistancesEverythingIsStatic) {
  for (const FilterRule rule : {FilterRule::kHmc, FilterRule::kEpipolar, FilterRule::kChiSquare}) {
    Frame without_boxes = personBeforeWall();
    without_boxes.boxes.clear();
    Frame without_distances = personBeforeWall();
    without_distances.distance.assign(14, kNaN);
    for (const Frame& frame : {without_boxes, without_distances}) {
      const FilterStageResult result = frame.filter(fixedStageOptions(rule));
      EXPECT_EQ(result.label, std::vector<L>(14, L::kStatic)) << toString(rule);
      EXPECT_EQ(result.weight, std::vector<float>(14, 1.0f)) << toString(rule);
      EXPECT_EQ(result.boxes.size(), frame.boxes.size());
    }
    EXPECT_EQ(without_distances.filter(fixedStageOptions(rule)).frame.measured, 0U);
    EXPECT_EQ(without_distances.filter(fixedStageOptions(rule)).frame.mean_distance, 0.0f);
  }
}

TEST(FilterStage, NoPointsAreFine) {
  Frame frame;
  frame.boxes = {{0.0f, 0.0f, 100.0f, 100.0f, kPersonClassId, 1.0f}};
  for (const FilterRule rule : kFilterRules) {
    const FilterStageResult result = frame.filter(fixedStageOptions(rule));
    EXPECT_TRUE(result.label.empty());
    EXPECT_EQ(result.boxes.size(), 1U);
  }
}

TEST(FilterStage, AllPointsInBoxes) {
  Frame frame = personBeforeWall();
  frame.boxes[0].x_max = 640.0f;
  const FilterStageResult result = frame.filter(fixedStageOptions(FilterRule::kHmc));
  EXPECT_EQ(result.frame.points_in_dynamic_boxes, 14U);
  EXPECT_EQ(result.frame.dynamic, 6U);
  EXPECT_EQ(result.frame.suspect, 8U);
}

TEST(FilterStage, APointInSeveralDynamicBoxesTakesTheStrictestVerdict) {
  // Given the person's box, and the box of a chair behind: 6 points at 5.0-5.1 m that move by 2 px.
  // The boxes share points 8 and 9 on the wall.
  Frame frame = personBeforeWall();
  for (int i = 0; i < 6; ++i) {
    frame.points.push_back(110.0f + static_cast<float>(i), 50.0f,
                           5.0f + 0.02f * static_cast<float>(i));
    frame.distance.push_back(2.0f);
  }
  const DetectionBox chair{75.0f, 0.0f, 150.0f, 100.0f, 56, 1.0f};
  const FilterStageOptions options = fixedStageOptions(FilterRule::kHmc);
  const FilterStageResult person_only = frame.filter(options);
  const DetectionBox person = frame.boxes[0];
  frame.boxes = {chair};
  const FilterStageResult chair_only = frame.filter(options);
  ASSERT_EQ(person_only.label[8], L::kSuspect);
  ASSERT_EQ(chair_only.label[8], L::kSuspect);
  ASSERT_NE(person_only.weight[8], chair_only.weight[8]);

  for (const bool chair_first : {true, false}) {
    frame.boxes = {person, chair};
    if (chair_first) {
      std::swap(frame.boxes[0], frame.boxes[1]);
    }
    const FilterStageResult both = frame.filter(options);
    EXPECT_EQ(both.label[8], L::kSuspect);
    EXPECT_EQ(both.weight[8], std::min(person_only.weight[8], chair_only.weight[8]));
    EXPECT_EQ(both.frame.points_in_dynamic_boxes, 16U);  // each point once
  }

  // Given that the two belong to the chair by depth: noise in one box, the chair's in the other.
  frame.points.depth[8] = frame.points.depth[9] = 5.05f;
  frame.distance[8] = frame.distance[9] = 0.8f;
  frame.boxes = {person};
  EXPECT_EQ(frame.filter(options).label[8], L::kSuspect);
  for (const bool chair_first : {true, false}) {
    frame.boxes = {person, chair};
    if (chair_first) {
      std::swap(frame.boxes[0], frame.boxes[1]);
    }
    // Then dynamic wins, whichever box comes first.
    EXPECT_EQ(frame.filter(options).label[8], L::kDynamic);
    EXPECT_EQ(frame.filter(options).weight[8], 0.0f);
  }
}

TEST(FilterStage, ClustersAreNumberedThroughTheFrame) {
  // Given noise in the first box that belongs to a cluster in the second: a wall point of its own.
  Frame frame = personBeforeWall();
  frame.boxes.push_back({95.0f, 0.0f, 250.0f, 100.0f, kPersonClassId, 1.0f});
  frame.boxes[0].x_max = 98.0f;
  frame.points.push_back(96.0f, 50.0f, 6.0f);  // 14, in both boxes
  frame.distance.push_back(3.0f);
  for (int i = 0; i < 5; ++i) {
    frame.points.push_back(120.0f + static_cast<float>(i), 50.0f, 6.0f);  // 15-19
    frame.distance.push_back(3.0f);
  }
  for (const bool swapped : {false, true}) {
    if (swapped) {
      std::swap(frame.boxes[0], frame.boxes[1]);
    }
    const FilterStageResult result = frame.filter(fixedStageOptions(FilterRule::kHmc));
    ASSERT_EQ(result.frame.dynamic_boxes, 2U);
    EXPECT_EQ(result.boxes[1].first_cluster, static_cast<int>(result.boxes[0].clusters.size()));
    // Then it has the cluster that it is in.
    EXPECT_EQ(result.cluster[14], result.cluster[15]) << "swapped " << swapped;
    EXPECT_NE(result.cluster[14], kNoise) << "swapped " << swapped;
  }
}

TEST(FilterStage, RulesOfThePeersThroughTheSameCall) {
  // Given a person at 3 px and a wall at 0.1 px in the box; everything else at 0.1 px.
  Frame frame = personBeforeWall();
  frame.distance[13] = 1.5f;  // outside the box
  const auto dynamic = [&](FilterRule rule) {
    std::vector<std::size_t> points;
    const FilterStageResult result = frame.filter(fixedStageOptions(rule));
    for (std::size_t i = 0; i < result.label.size(); ++i) {
      EXPECT_EQ(result.weight[i], result.label[i] == L::kDynamic ? 0.0f : 1.0f);
      if (result.label[i] == L::kDynamic) {
        points.push_back(i);
      } else {
        EXPECT_EQ(result.label[i], L::kStatic);
      }
    }
    EXPECT_EQ(result.frame.dynamic, points.size());
    EXPECT_EQ(result.frame.points_in_dynamic_boxes, 10U);
    return points;
  };
  using Set = std::vector<std::size_t>;
  const Set person{0, 1, 2, 3, 4, 5};
  EXPECT_EQ(dynamic(FilterRule::kNone), Set{});
  EXPECT_EQ(dynamic(FilterRule::kBox), (Set{0, 1, 2, 3, 4, 5, 6, 7, 8, 9}));
  EXPECT_EQ(dynamic(FilterRule::kDynamicBox), (Set{0, 1, 2, 3, 4, 5, 6, 7, 8, 9}));
  EXPECT_EQ(dynamic(FilterRule::kEpipolar), person);
  EXPECT_EQ(dynamic(FilterRule::kTwoThreshold), (Set{0, 1, 2, 3, 4, 5, 13}));
  EXPECT_EQ(dynamic(FilterRule::kChiSquare), person);
  EXPECT_EQ(dynamic(FilterRule::kDepthRansac), person);
}

TEST(FilterStage, RulesHaveNames) {
  const std::vector<std::string> names{"none",          "box",  "dynamic_box",  "epipolar",
                                       "two_threshold", "chi2", "depth_ransac", "hmc"};
  ASSERT_EQ(std::size(kFilterRules), names.size());
  for (std::size_t i = 0; i < names.size(); ++i) {
    EXPECT_EQ(toString(kFilterRules[i]), names[i]);
    EXPECT_EQ(filterRuleFromString(names[i]), kFilterRules[i]);
  }
  EXPECT_EQ(filterRuleFromString("HMC"), std::nullopt);
  EXPECT_EQ(filterRuleFromString(""), std::nullopt);
}

TEST(FilterStage, UnequalSizesAreRefused) {
  Frame frame = personBeforeWall();
  frame.distance.pop_back();
  EXPECT_EQ(test::invalidArgumentOf([&] { frame.filter(fixedStageOptions(FilterRule::kHmc)); }),
            "filterKeyPoints: 14 key points, but 13 distances; expected equal sizes");
  frame = personBeforeWall();
  frame.points.depth.pop_back();
  EXPECT_NE(test::invalidArgumentOf([&] { frame.filter(fixedStageOptions(FilterRule::kHmc)); }),
            "nothing thrown");
}

TEST(FilterStage, BadOptionsAreRefusedWhateverTheRuleAndTheFrame) {
  const auto message = [](auto change) {
    FilterStageOptions options = fixedStageOptions(FilterRule::kNone);
    change(options);
    return test::invalidArgumentOf([&] { Frame().filter(options); });
  };
  using Options = FilterStageOptions;
  for (const std::string& text :
       {message([](Options& o) { o.boxes.dynamic_ratio = -1.0f; }),
        message([](Options& o) { o.clustering.epsilon = -1.0f; }),
        message([](Options& o) { o.cluster_filter.min_cluster_size = 0; }),
        message([](Options& o) { o.weights.without_depth = 2.0f; }),
        message([](Options& o) { o.two_threshold.inside_threshold = kNaN; }),
        message([](Options& o) { o.chi_square.sigma = -1.0f; }),
        message([](Options& o) { o.depth_ransac.confidence = 1.0f; })}) {
    EXPECT_NE(text, "nothing thrown");
  }
  EXPECT_EQ(message([](Options&) {}), "nothing thrown");
}

}  // namespace
}  // namespace hmcdyn

// SPDX-License-Identifier: BSD-3-Clause
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <hmcdyn/steps/box_dynamism.hpp>

#include "constants.hpp"
#include "invalid_argument.hpp"

namespace hmcdyn {
namespace {

using test::kChairClassId;

BoxDynamismOptions paperOptions() {
  BoxDynamismOptions options;
  options.distance_threshold = 1.0f;
  options.person_distance_threshold = 0.9f;
  options.dynamic_ratio = 0.1f;
  options.person_class_id = kPersonClassId;
  return options;
}

DetectionBox box(float x_min, float y_min, float x_max, float y_max, int class_id) {
  return {x_min, y_min, x_max, y_max, class_id, 1.0f};
}

/// Key points (0, 0), (1, 0), (2, 0) ... with depth 1 m.
KeyPoints pointsInARow(std::size_t n) {
  KeyPoints points;
  for (std::size_t i = 0; i < n; ++i) {
    points.push_back(static_cast<float>(i), 0.0f, 1.0f);
  }
  return points;
}

BoxDynamism test(const std::vector<float>& distance, const std::vector<DetectionBox>& boxes,
                 const BoxDynamismOptions& options = paperOptions()) {
  const KeyPoints points = pointsInARow(distance.size());
  return testBoxes(distance, boxes, assignToBoxes(points.view(), boxes), options);
}

/// One box over all points, of which some have a distance of 5 px and the rest one of 0.
BoxVerdict verdictOf(std::size_t dynamic, std::size_t points) {
  std::vector<float> distance(points, 0.0f);
  std::fill_n(distance.begin(), dynamic, 5.0f);
  return test(distance, {box(-1, -1, 1e6f, 1, kChairClassId)}).boxes[0];
}

std::vector<std::uint32_t> members(const BoxMembership& membership, std::size_t b) {
  const Span<const std::uint32_t> span = membership.pointsIn(b);
  return {span.begin(), span.end()};
}

TEST(BoxDynamism, DefaultsAreThePapersValues) {
  const BoxDynamismOptions options;
  EXPECT_FLOAT_EQ(options.distance_threshold, 1.0f);
  EXPECT_FLOAT_EQ(options.person_distance_threshold, 0.9f);
  EXPECT_FLOAT_EQ(options.dynamic_ratio, 0.1f);
  EXPECT_EQ(options.person_class_id, 0);
}

TEST(BoxMembership, BordersBelongToTheBoxAndOrderIsThePoints) {
  const KeyPoints points = pointsInARow(6);
  const std::vector<DetectionBox> boxes{box(2, 0, 4, 0, 0), box(3, -1, 9, 1, 0)};
  const BoxMembership membership = assignToBoxes(points.view(), boxes);
  ASSERT_EQ(membership.boxes(), 2U);
  EXPECT_EQ(members(membership, 0), (std::vector<std::uint32_t>{2, 3, 4}));
  EXPECT_EQ(members(membership, 1), (std::vector<std::uint32_t>{3, 4, 5}));
}

TEST(BoxMembership, UnusableBoxesHoldNoPoint) {
  const KeyPoints points = pointsInARow(5);
  const float infinity = std::numeric_limits<float>::infinity();
  const std::vector<DetectionBox> boxes{
      box(4, 1, 0, -1, 0),                               // inverted
      box(0, -1, 4, kNaN, 0),                            // NaN
      box(0.2f, 0, 0.8f, 0, 0),                          // between two points
      box(700, 500, 900, 800, 0),                        // outside every image
      box(-50, -50, -10, -10, 0),                        // outside, at the other side
      box(-infinity, -infinity, infinity, infinity, 0),  // everything
      box(-100, -100, 2, 100, 0),                        // reaches outside
  };
  const BoxMembership membership = assignToBoxes(points.view(), boxes);
  ASSERT_EQ(membership.boxes(), 7U);
  for (std::size_t b = 0; b < 5; ++b) {
    EXPECT_TRUE(membership.pointsIn(b).empty()) << "box " << b;
  }
  EXPECT_EQ(membership.pointsIn(5).size(), 5U);
  EXPECT_EQ(members(membership, 6), (std::vector<std::uint32_t>{0, 1, 2}));
}

TEST(BoxMembership, HoldsWhatTheBoxContainsWhateverTheNumberOfPoints) {
  for (const std::size_t n : {1U, 31U, 32U, 63U, 64U, 65U, 96U, 127U, 128U, 129U, 200U, 1000U}) {
    const KeyPoints points = pointsInARow(n);
    const DetectionBox middle = box(static_cast<float>(n) / 3, 0, static_cast<float>(n), 0, 0);
    std::vector<std::uint32_t> expected;
    for (std::size_t i = 0; i < n; ++i) {
      if (middle.contains(points.u[i], points.v[i])) {
        expected.push_back(static_cast<std::uint32_t>(i));
      }
    }
    const BoxMembership membership =
        assignToBoxes(points.view(), std::vector<DetectionBox>{middle, box(-1, -1, 1e6, 1, 0)});
    EXPECT_EQ(members(membership, 0), expected) << n << " points";
    EXPECT_EQ(membership.pointsIn(1).size(), n);
  }
}

TEST(BoxMembership, ReusedMemoryLeavesNothingBehind) {
  const KeyPoints points = pointsInARow(5);
  BoxMembership membership =
      assignToBoxes(points.view(), std::vector<DetectionBox>(3, box(0, 0, 9, 9, 0)));
  membership = assignToBoxes(points.view(), std::vector<DetectionBox>{box(1, 0, 1, 0, 0)},
                             std::move(membership));
  ASSERT_EQ(membership.boxes(), 1U);
  EXPECT_EQ(members(membership, 0), (std::vector<std::uint32_t>{1}));
  EXPECT_EQ(assignToBoxes(points.view(), {}, std::move(membership)).boxes(), 0U);
}

TEST(BoxMembership, UnequalArraysAreRefused) {
  KeyPoints points = pointsInARow(3);
  points.v.pop_back();
  EXPECT_NE(test::invalidArgumentOf([&] { assignToBoxes(points.view(), {}); }), "nothing thrown");
}

TEST(BoxDynamism, ExactlyTenPercentIsNotDynamic) {
  for (std::size_t tenth = 1; tenth <= 200; ++tenth) {
    EXPECT_FALSE(verdictOf(tenth, 10 * tenth).is_dynamic) << tenth << " of " << 10 * tenth;
    EXPECT_TRUE(verdictOf(tenth + 1, 10 * tenth).is_dynamic) << tenth + 1 << " of " << 10 * tenth;
    EXPECT_TRUE(verdictOf(tenth, 10 * tenth - 1).is_dynamic) << tenth << " of " << 10 * tenth - 1;
  }
}

TEST(BoxDynamism, OnePixelForThingsAndLessForPeople) {
  // Given distances around both thresholds, all in one box.
  const std::vector<float> distance{0.89f, 0.9f, 0.91f, 1.0f, 1.01f};
  const BoxDynamism person = test(distance, {box(0, 0, 9, 9, kPersonClassId)});
  const BoxDynamism chair = test(distance, {box(0, 0, 9, 9, kChairClassId)});

  // Then a distance at the threshold is not beyond it.
  EXPECT_EQ(person.boxes[0].dynamic, 3U);
  EXPECT_EQ(chair.boxes[0].dynamic, 1U);
  EXPECT_EQ(person.threshold, std::vector<float>(5, 0.9f));
  EXPECT_EQ(chair.threshold, std::vector<float>(5, 1.0f));
}

TEST(BoxDynamism, ThePersonsClassIsTheDetectors) {
  BoxDynamismOptions options = paperOptions();
  options.person_class_id = 15;
  EXPECT_EQ(test({0.95f}, {box(0, 0, 1, 1, 15)}, options).boxes[0].dynamic, 1U);
  EXPECT_EQ(test({0.95f}, {box(0, 0, 1, 1, 0)}, options).boxes[0].dynamic, 0U);
}

TEST(BoxDynamism, APointInSeveralBoxesTakesTheStrictestThreshold) {
  // Given points 0-9 in the chair, 5-14 in the person, 15 in neither; 5 is at 0.95 px.
  std::vector<float> distance(16, 0.0f);
  distance[4] = distance[5] = distance[10] = distance[15] = 0.95f;
  for (const bool chair_first : {true, false}) {
    std::vector<DetectionBox> boxes{box(0, 0, 9, 0, kChairClassId), box(5, 0, 14, 0, 0)};
    if (!chair_first) {
      std::swap(boxes[0], boxes[1]);
    }
    const BoxDynamism result = test(distance, boxes);
    const BoxVerdict& chair = result.boxes[chair_first ? 0 : 1];
    const BoxVerdict& person = result.boxes[chair_first ? 1 : 0];

    // Then 5 counts as dynamic in the chair, too; 4 does not.
    EXPECT_EQ(chair.dynamic, 1U);
    EXPECT_EQ(person.dynamic, 2U);
    EXPECT_FLOAT_EQ(result.threshold[4], 1.0f);
    EXPECT_FLOAT_EQ(result.threshold[5], 0.9f);
    EXPECT_FLOAT_EQ(result.threshold[14], 0.9f);
    EXPECT_FLOAT_EQ(result.threshold[15], 1.0f);
  }
}

TEST(BoxDynamism, UnmatchedPointsCountAsPointsOfTheBox) {
  // Given 10 points: one dynamic, 8 without a distance. One of ten is not more than 10 %.
  std::vector<float> distance(10, kNaN);
  distance[0] = 5.0f;
  distance[1] = 0.0f;
  const BoxVerdict verdict = test(distance, {box(0, 0, 9, 0, kChairClassId)}).boxes[0];
  EXPECT_EQ(verdict.points, 10U);
  EXPECT_EQ(verdict.measured, 2U);
  EXPECT_EQ(verdict.dynamic, 1U);
  EXPECT_FALSE(verdict.is_dynamic);
}

TEST(BoxDynamism, EmptyBoxesAreNotDynamic) {
  BoxDynamismOptions options = paperOptions();
  options.dynamic_ratio = 0.0f;
  const BoxDynamism result =
      test({5.0f}, {box(9, 9, 5, 5, 0), box(3, 3, 4, 4, 0), box(kNaN, 0, 9, 9, 0)}, options);
  for (const BoxVerdict& verdict : result.boxes) {
    EXPECT_EQ(verdict.points, 0U);
    EXPECT_FALSE(verdict.is_dynamic);
  }
  EXPECT_TRUE(test({}, {box(0, 0, 1, 1, 0)}).threshold.empty());
  EXPECT_TRUE(test({5.0f}, {}).boxes.empty());
}

TEST(BoxDynamism, ReusedMemoryLeavesNothingBehind) {
  const KeyPoints points = pointsInARow(3);
  const std::vector<DetectionBox> boxes{box(0, 0, 1, 0, kPersonClassId)};
  const BoxMembership membership = assignToBoxes(points.view(), boxes);
  BoxDynamism old;
  old.boxes.assign(7, BoxVerdict{9, 9, 9, true});
  old.threshold.assign(50, 0.01f);
  const std::vector<float> distance{0.5f, 0.5f, 0.5f};
  const BoxDynamism result = testBoxes(distance, boxes, membership, paperOptions(), std::move(old));
  ASSERT_EQ(result.boxes.size(), 1U);
  EXPECT_EQ(result.boxes[0].points, 2U);
  EXPECT_EQ(result.boxes[0].dynamic, 0U);
  EXPECT_EQ(result.threshold, (std::vector<float>{0.9f, 0.9f, 1.0f}));
}

TEST(BoxDynamism, MembershipOfOtherBoxesOrPointsIsRefused) {
  const KeyPoints points = pointsInARow(4);
  const std::vector<DetectionBox> boxes{box(0, 0, 9, 9, 0)};
  const BoxMembership membership = assignToBoxes(points.view(), boxes);
  const std::vector<float> four(4, 0.0f);
  const std::vector<float> three(3, 0.0f);
  EXPECT_EQ(test::invalidArgumentOf([&] { testBoxes(four, {}, membership, paperOptions()); }),
            "testBoxes: membership of 1 boxes for 0 boxes");
  // Point 3 is in the box, but has no distance.
  EXPECT_EQ(test::invalidArgumentOf([&] { testBoxes(three, boxes, membership, paperOptions()); }),
            "testBoxes: membership holds point 3, but there are 3 points; expected the membership "
            "of these points");
}

TEST(BoxDynamism, OptionsOutOfRangeAreNamed) {
  const auto message = [](auto change) {
    BoxDynamismOptions options = paperOptions();
    change(options);
    return test::invalidArgumentOf([&] { checkOptions(options); });
  };
  using Options = BoxDynamismOptions;
  EXPECT_EQ(message([](Options& o) { o.distance_threshold = -1.0f; }),
            "BoxDynamismOptions::distance_threshold is -1.000000; expected a value >= 0 (px)");
  EXPECT_EQ(message([](Options& o) { o.person_distance_threshold = kNaN; }),
            "BoxDynamismOptions::person_distance_threshold is nan; expected a value >= 0 (px)");
  EXPECT_EQ(message([](Options& o) { o.dynamic_ratio = 1.5f; }),
            "BoxDynamismOptions::dynamic_ratio is 1.500000; expected a share in [0, 1]");
  EXPECT_EQ(message([](Options&) {}), "nothing thrown");
}

}  // namespace
}  // namespace hmcdyn

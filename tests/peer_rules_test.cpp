// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <hmcdyn/peers/peer_rules.hpp>

#include "constants.hpp"
#include "invalid_argument.hpp"
#include "random.hpp"

namespace hmcdyn {
namespace {

using test::kChairClassId;

using Flags = std::vector<std::uint8_t>;
using Indices = std::vector<std::uint32_t>;

BoxMembership membershipOf(const std::vector<Indices>& boxes) {
  BoxMembership membership;
  membership.offsets.push_back(0);
  for (const Indices& box : boxes) {
    membership.indices.insert(membership.indices.end(), box.begin(), box.end());
    membership.offsets.push_back(membership.indices.size());
  }
  return membership;
}

std::vector<DetectionBox> boxesOf(const std::vector<int>& classes) {
  std::vector<DetectionBox> boxes;
  for (const int class_id : classes) {
    boxes.push_back({0.0f, 0.0f, 1.0f, 1.0f, class_id, 1.0f});
  }
  return boxes;
}

Indices indicesOf(const Flags& flags) {
  Indices set;
  for (std::uint32_t i = 0; i < flags.size(); ++i) {
    if (flags[i] != 0) {
      set.push_back(i);
    }
  }
  return set;
}

TEST(DropWholeBoxes, TakesEveryPointOfEveryBox) {
  EXPECT_EQ(dropWholeBoxes(6, membershipOf({{1, 2}, {}, {2, 5}})), (Flags{0, 1, 1, 0, 0, 1}));
  EXPECT_EQ(dropWholeBoxes(3, membershipOf({})), (Flags{0, 0, 0}));
  EXPECT_EQ(dropWholeBoxes(3, BoxMembership{}), (Flags{0, 0, 0}));
}

TEST(DropBeyondThreshold, JudgesPointsOfDynamicBoxesOnly) {
  // Given point 0-2 in a dynamic box, 2-3 in a static one, 4 in none.
  const std::vector<float> distance{0.5f, 1.2f, 0.95f, 9.0f, 9.0f, 9.0f};
  BoxDynamism dynamism;
  dynamism.boxes = {BoxVerdict{3, 3, 1, true}, BoxVerdict{2, 2, 0, false}};
  dynamism.threshold = {1.0f, 1.0f, 0.9f, 1.0f, 1.0f, 1.0f};
  EXPECT_EQ(indicesOf(dropBeyondThreshold(distance, membershipOf({{0, 1, 2}, {2, 3}}), dynamism)),
            (Indices{1, 2}));
}

TEST(DropBeyondThreshold, AtTheThresholdOrWithoutADistanceIsKept) {
  BoxDynamism dynamism;
  dynamism.boxes = {BoxVerdict{2, 1, 1, true}};
  dynamism.threshold = {1.0f, 1.0f};
  EXPECT_EQ(dropBeyondThreshold(std::vector<float>{1.0f, kNaN}, membershipOf({{0, 1}}), dynamism),
            (Flags{0, 0}));
}

TwoThresholdOptions twoThresholds(float revert_share) {
  TwoThresholdOptions options;
  options.outside_threshold = 1.0f;
  options.inside_threshold = 0.2f;
  options.revert_share = revert_share;
  return options;
}

TEST(TwoThresholds, AreTighterInsidePeople) {
  // Given points 0-3 in a person, 3-6 in a chair, 7-8 in no box.
  const std::vector<float> distance{0.1f, 0.2f, 0.3f, 0.3f, 0.3f, 1.5f, kNaN, 0.9f, 1.1f};
  const Flags dynamic = dropByTwoThresholds(distance, boxesOf({kPersonClassId, kChairClassId}),
                                            membershipOf({{0, 1, 2, 3}, {3, 4, 5, 6}}),
                                            kPersonClassId, twoThresholds(0.0f));
  EXPECT_EQ(indicesOf(dynamic), (Indices{2, 3, 5, 8}));
}

TEST(TwoThresholds, RevertWhereTooFewPointsWouldRemain) {
  // Given 10 points of which 9 move: one of ten remains.
  std::vector<float> distance(10, 5.0f);
  distance[3] = 0.0f;
  const auto dropped = [&](float share) {
    return indicesOf(dropByTwoThresholds(distance, {}, BoxMembership{}, kPersonClassId,
                                         twoThresholds(share)))
        .size();
  };
  EXPECT_EQ(dropped(0.1f), 9U);
  EXPECT_EQ(dropped(0.11f), 0U);
}

TEST(ChiSquare, CutsAtTheQuantileInBoxesOnly) {
  // Given sigma 0.5 px and the 95 % quantile 3.8415: the limit is 0.5 * 1.95998 = 0.97999 px.
  ChiSquareOptions options;
  options.sigma = 0.5f;
  options.quantile = 3.8415f;
  const std::vector<float> distance{0.979f, 0.981f, kNaN, 9.0f, 9.0f};
  EXPECT_EQ(indicesOf(dropByChiSquare(distance, membershipOf({{0, 1, 2}, {1, 3}}), options)),
            (Indices{1, 3}));
  // Exactly at the quantile is kept.
  options.sigma = 1.0f;
  options.quantile = 4.0f;
  EXPECT_EQ(dropByChiSquare(std::vector<float>{2.0f}, membershipOf({{0}}), options), Flags{0});
}

DepthRansacOptions depthRansac(std::uint32_t seed) {
  DepthRansacOptions options;
  options.variance_threshold = 0.02f;  // two equal draws: within 0.3 m
  options.confidence = 0.99f;
  options.max_iterations = 200;
  options.seed = seed;
  return options;
}

TEST(DepthRansac, FindsTheDepthOfMostPoints) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    // Given a box with 30 points of a person about 2 m away, 12 of a wall at 4 m, and 3 without
    // depth; and a point at 2 m outside.
    test::Random random(seed);
    std::vector<float> depth;
    Indices box;
    Indices person;
    for (std::uint32_t i = 0; i < 45; ++i) {
      const bool in_person = i % 3 != 0;
      depth.push_back(in_person     ? random.uniformFloat(1.97, 2.03)
                      : i % 15 == 0 ? 0.0f
                                    : random.uniformFloat(3.95, 4.05));
      box.push_back(i);
      if (in_person) {
        person.push_back(i);
      }
    }
    depth.push_back(2.0f);
    EXPECT_EQ(indicesOf(dropByDepthRansac(depth, membershipOf({box}), depthRansac(seed))), person)
        << "seed " << seed;
  }
}

TEST(DepthRansac, RepeatsForASeed) {
  test::Random random(3);
  std::vector<float> depth;
  Indices box;
  for (std::uint32_t i = 0; i < 60; ++i) {
    depth.push_back(random.uniformFloat(1.0, 5.0));
    box.push_back(i);
  }
  const BoxMembership membership = membershipOf({box, {4, 5, 6, 7, 8, 9, 10}});
  DepthRansacOptions options = depthRansac(7);
  options.max_iterations = 5;  // far from done, so that seeds differ
  const Flags first = dropByDepthRansac(depth, membership, options);
  EXPECT_EQ(dropByDepthRansac(depth, membership, options), first);
  bool any_differs = false;
  for (options.seed = 8; options.seed < 28; ++options.seed) {
    any_differs = any_differs || dropByDepthRansac(depth, membership, options) != first;
  }
  EXPECT_TRUE(any_differs);
}

TEST(DepthRansac, BoxesWithTooFewDepthsAreKept) {
  const std::vector<float> depth{2.0f, 2.0f, 0.0f, kNaN};
  EXPECT_EQ(dropByDepthRansac(depth, membershipOf({{0, 1, 2, 3}, {}}), depthRansac(1)),
            (Flags{0, 0, 0, 0}));
}

TEST(PeerRules, MembershipOfOtherPointsIsRefused) {
  const std::vector<float> two(2, 1.0f);
  const BoxMembership membership = membershipOf({{0, 2}});
  BoxDynamism dynamism;
  dynamism.boxes = {BoxVerdict{2, 2, 2, true}};
  dynamism.threshold = {1.0f, 1.0f};
  const auto expected = [](const char* caller) {
    return std::string(caller) +
           ": membership holds point 2, but there are 2 points; expected the membership of these "
           "points";
  };
  EXPECT_EQ(test::invalidArgumentOf([&] { dropWholeBoxes(2, membership); }),
            expected("dropWholeBoxes"));
  EXPECT_EQ(test::invalidArgumentOf([&] { dropBeyondThreshold(two, membership, dynamism); }),
            expected("dropBeyondThreshold"));
  EXPECT_EQ(test::invalidArgumentOf([&] {
              dropByTwoThresholds(two, boxesOf({0}), membership, 0, twoThresholds(0.1f));
            }),
            expected("dropByTwoThresholds"));
  EXPECT_EQ(test::invalidArgumentOf([&] { dropByChiSquare(two, membership, {}); }),
            expected("dropByChiSquare"));
  EXPECT_EQ(test::invalidArgumentOf([&] { dropByDepthRansac(two, membership, depthRansac(1)); }),
            expected("dropByDepthRansac"));
}

TEST(PeerRules, VerdictsOrBoxesOfOtherSizesAreRefused) {
  const std::vector<float> two(2, 1.0f);
  const BoxMembership membership = membershipOf({{0}, {1}});
  BoxDynamism dynamism;
  dynamism.boxes = {BoxVerdict{1, 1, 1, true}};
  dynamism.threshold = {1.0f, 1.0f};
  EXPECT_EQ(test::invalidArgumentOf([&] { dropBeyondThreshold(two, membership, dynamism); }),
            "dropBeyondThreshold: 2 distances in 2 boxes, but dynamism of 2 points in 1 boxes");
  EXPECT_EQ(test::invalidArgumentOf([&] {
              dropByTwoThresholds(two, boxesOf({0}), membership, 0, twoThresholds(0.1f));
            }),
            "dropByTwoThresholds: membership of 2 boxes for 1 boxes");
}

TEST(PeerRules, OptionsOutOfRangeAreNamed) {
  const auto message = [](auto options, auto change) {
    change(options);
    return test::invalidArgumentOf([&] { checkOptions(options); });
  };
  const TwoThresholdOptions two;
  using Two = TwoThresholdOptions;
  EXPECT_EQ(message(two, [](Two& o) { o.outside_threshold = kNaN; }),
            "TwoThresholdOptions::outside_threshold is nan; expected a value >= 0 (px)");
  EXPECT_EQ(message(two, [](Two& o) { o.inside_threshold = -1.0f; }),
            "TwoThresholdOptions::inside_threshold is -1.000000; expected a value >= 0 (px)");
  EXPECT_EQ(message(two, [](Two& o) { o.revert_share = 2.0f; }),
            "TwoThresholdOptions::revert_share is 2.000000; expected a share in [0, 1]");
  const ChiSquareOptions chi;
  using Chi = ChiSquareOptions;
  EXPECT_EQ(message(chi, [](Chi& o) { o.sigma = 0.0f; }),
            "ChiSquareOptions::sigma is 0.000000; expected a value > 0 (px)");
  EXPECT_EQ(message(chi, [](Chi& o) { o.quantile = kNaN; }),
            "ChiSquareOptions::quantile is nan; expected a value >= 0");
  const DepthRansacOptions ransac;
  using Ransac = DepthRansacOptions;
  EXPECT_EQ(message(ransac, [](Ransac& o) { o.variance_threshold = 0.0f; }),
            "DepthRansacOptions::variance_threshold is 0.000000; expected a value > 0 (m^2)");
  EXPECT_EQ(message(ransac, [](Ransac& o) { o.confidence = 1.0f; }),
            "DepthRansacOptions::confidence is 1.000000; expected a probability in (0, 1)");
  EXPECT_EQ(message(ransac, [](Ransac& o) { o.max_iterations = 0; }),
            "DepthRansacOptions::max_iterations is 0.000000; expected a count >= 1");
  EXPECT_EQ(message(two, [](Two&) {}), "nothing thrown");
  EXPECT_EQ(message(chi, [](Chi&) {}), "nothing thrown");
  EXPECT_EQ(message(ransac, [](Ransac&) {}), "nothing thrown");
}

}  // namespace
}  // namespace hmcdyn

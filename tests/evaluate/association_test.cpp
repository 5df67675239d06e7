// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/association.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "expect_throw.hpp"

namespace hmcdyn::evaluate {
namespace {

using Pairs = std::vector<IndexPair>;

TEST(Association, TheClosestPairGoesFirst) {
  // 1.00 is nearest to 1.01, but 1.01 is nearer to 1.013, which leaves 1.00 with 0.985.
  const std::vector<double> first{1.0, 1.013};
  const std::vector<double> second{0.985, 1.01};
  EXPECT_EQ(associate(first, second), (Pairs{{0, 0}, {1, 1}}));
}

TEST(Association, ALosingStampStaysAlone) {
  const std::vector<double> first{1.0, 1.004};
  const std::vector<double> second{1.003};
  EXPECT_EQ(associate(first, second), (Pairs{{1, 0}}));
}

TEST(Association, TheToleranceIsExcluded) {
  const std::vector<double> first{0.0, 1.0};
  const std::vector<double> second{0.25, 1.125};
  EXPECT_EQ(associate(first, second, {0.25, 0.0}), (Pairs{{1, 1}}));
}

TEST(Association, TheOffsetIsAddedToTheSecondList) {
  const std::vector<double> first{10.0, 11.0};
  const std::vector<double> second{5.0, 6.0};
  EXPECT_TRUE(associate(first, second).empty());
  EXPECT_EQ(associate(first, second, {0.02, 5.0}), (Pairs{{0, 0}, {1, 1}}));
}

TEST(Association, ATieGoesToTheEarlierStamps) {
  // 1.0 and 2.0 are equally far from 1.5, which 1.0 gets; 3.0 has 2.5 and 3.5 to choose from.
  const std::vector<double> first{1.0, 2.0, 3.0};
  EXPECT_EQ(associate(first, std::vector<double>{1.5}, {0.6, 0.0}), (Pairs{{0, 0}}));
  EXPECT_EQ(associate(std::vector<double>{3.0}, std::vector<double>{2.5, 3.5}, {0.6, 0.0}),
            (Pairs{{0, 0}}));
}

TEST(Association, DoubledStampsGoByTheirIndex) {
  const std::vector<double> first{1.0, 1.0};
  const std::vector<double> second{1.0, 1.0, 1.0};
  EXPECT_EQ(associate(first, second), (Pairs{{0, 0}, {1, 1}}));
}

TEST(Association, UnsortedListsGivePairsInTheOrderOfTime) {
  const std::vector<double> first{3.0, 1.0, 2.0};
  const std::vector<double> second{2.001, 3.001, 1.001};
  EXPECT_EQ(associate(first, second), (Pairs{{1, 2}, {2, 0}, {0, 1}}));
}

TEST(Association, EmptyListsHaveNoPairs) {
  EXPECT_TRUE(associate({}, std::vector<double>{1.0}).empty());
  EXPECT_TRUE(associate(std::vector<double>{1.0}, {}).empty());
}

/// The definition, word for word: over and over the closest pair of what is left.
Pairs associateByDefinition(const std::vector<double>& first, const std::vector<double>& second,
                            double tolerance) {
  std::vector<bool> first_taken(first.size(), false);
  std::vector<bool> second_taken(second.size(), false);
  Pairs pairs;
  while (true) {
    double least = tolerance;
    IndexPair best;
    for (std::size_t i = 0; i < first.size(); ++i) {
      for (std::size_t j = 0; j < second.size(); ++j) {
        const double difference = std::abs(first[i] - second[j]);
        if (!first_taken[i] && !second_taken[j] && difference < least) {
          least = difference;
          best = {i, j};
        }
      }
    }
    if (least == tolerance) {
      break;
    }
    first_taken[best.first] = true;
    second_taken[best.second] = true;
    pairs.push_back(best);
  }
  std::sort(pairs.begin(), pairs.end(), [&](const IndexPair& a, const IndexPair& b) {
    return first[a.first] < first[b.first];
  });
  return pairs;
}

TEST(Association, AgreesWithTheDefinitionOnRandomLists) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> time(0.0, 3.0);
  for (int round = 0; round < 20; ++round) {
    std::vector<double> first(60);
    std::vector<double> second(90);
    std::generate(first.begin(), first.end(), [&] { return time(random); });
    std::generate(second.begin(), second.end(), [&] { return time(random); });
    EXPECT_EQ(associate(first, second, {0.05, 0.0}), associateByDefinition(first, second, 0.05));
  }
}

TEST(Association, RefusesBadOptionsAndStamps) {
  const std::vector<double> good{1.0};
  const std::vector<double> bad{1.0, std::numeric_limits<double>::quiet_NaN()};
  EXPECT_EQ(test::messageOf<std::invalid_argument>([&] {
              associate(good, good, {0.0, 0.0});
            }),
            "associate: tolerance is 0 s; expected more than 0");
  EXPECT_EQ(test::messageOf<std::invalid_argument>([&] { associate(good, bad); }),
            "associate: second holds nan at 1; expected finite times");
  EXPECT_THROW(associate(good, good, {0.02, std::numeric_limits<double>::infinity()}),
               std::invalid_argument);
}

}  // namespace
}  // namespace hmcdyn::evaluate

// SPDX-License-Identifier: BSD-3-Clause
#include "slam/input/dataset/association.hpp"

#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

namespace hmcdyn::slam {
namespace {

using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;

TEST(Association, TheSmallestDifferenceIsTakenFirst) {
  // Given b[0] within the tolerance of both a, and nearer to the second.
  const Pairs pairs = associate({1.00, 1.03}, {1.02, 1.20}, 0.025);
  // Then the first is left without a partner, although it would come first in time.
  EXPECT_EQ(pairs, (Pairs{{1, 0}}));
}

TEST(Association, EachTimeStampIsUsedOnce) {
  const Pairs pairs = associate({1.0, 1.5, 2.0}, {1.25, 1.75}, 0.25);
  // All four differences are 0.25: ties go by the order in a, then b.
  EXPECT_EQ(pairs, (Pairs{{0, 0}, {1, 1}}));
}

TEST(Association, TheToleranceItselfIsAllowedAndMoreIsNot) {
  EXPECT_EQ(associate({1.0}, {1.25}, 0.25), (Pairs{{0, 0}}));
  EXPECT_TRUE(associate({1.0}, {1.25}, 0.2499).empty());
  EXPECT_EQ(associate({3.0}, {3.0}, 0.0), (Pairs{{0, 0}}));
}

TEST(Association, UnsortedInputGivesPairsInTheOrderOfTime) {
  EXPECT_EQ(associate({3.0, 1.0, 2.0}, {2.01, 3.01, 1.01}, 0.02), (Pairs{{1, 2}, {2, 0}, {0, 1}}));
}

TEST(Association, NothingHasNoPartner) {
  EXPECT_TRUE(associate({}, {1.0}, 1.0).empty());
  EXPECT_TRUE(associate({1.0}, {}, 1.0).empty());
}

TEST(Association, ANegativeOrNaNToleranceIsRefused) {
  EXPECT_THROW(associate({1.0}, {1.0}, -0.1), std::invalid_argument);
  EXPECT_THROW(associate({1.0}, {1.0}, std::numeric_limits<double>::quiet_NaN()),
               std::invalid_argument);
}

}  // namespace
}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#include "slam/features/spread_corners.hpp"

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <set>
#include <utility>

#include <gtest/gtest.h>

namespace hmcdyn::slam {
namespace {

Corner corner(int x, int y, int score) { return {x, y, score, 16 * score}; }

bool holds(const std::vector<Corner>& corners, int x, int y) {
  return std::any_of(corners.begin(), corners.end(),
                     [&](const Corner& c) { return c.x == x && c.y == y; });
}

/// Corners on a grid of 10 px over 200 x 200, weak, and a block of 15 x 15 strong ones.
std::vector<Corner> gridWithCluster() {
  std::vector<Corner> corners;
  for (int y = 5; y < 200; ++y) {
    for (int x = 5; x < 200; ++x) {
      if (x >= 140 && x < 155 && y >= 40 && y < 55) {
        corners.push_back(corner(x, y, 100));
      } else if (x % 10 == 5 && y % 10 == 5) {
        corners.push_back(corner(x, y, 10));
      }
    }
  }
  return corners;
}

TEST(KeepStrongPerCell, WeakCornersCountOnlyInCellsWithoutAStrongOne) {
  const std::vector<Corner> corners{corner(5, 5, 12), corner(20, 8, 25),    // cell 0: strong one
                                    corner(45, 5, 8), corner(70, 30, 20)};  // cell 1: none above 20
  const std::vector<Corner> kept = keepStrongPerCell(corners, 20, 40, {80, 40});
  ASSERT_EQ(kept.size(), 3U);
  EXPECT_FALSE(holds(kept, 5, 5));
  EXPECT_TRUE(holds(kept, 20, 8));
  EXPECT_TRUE(holds(kept, 45, 5));
  EXPECT_TRUE(holds(kept, 70, 30));
}

TEST(ShareOverLevels, FollowsTheScaleFactor) {
  EXPECT_EQ(shareOverLevels(7, {100, 100, 100}, 2.0f), (std::vector<int>{4, 2, 1}));
}

TEST(ShareOverLevels, WhatALevelLacksGoesToTheOthers) {
  // 4, 2, 1 wanted, 2 there; the missing 2 go to the upper levels.
  EXPECT_EQ(shareOverLevels(7, {2, 100, 100}, 2.0f), (std::vector<int>{2, 3, 2}));
}

TEST(ShareOverLevels, TakesEverythingWhereThereIsTooLittle) {
  EXPECT_EQ(shareOverLevels(1000, {3, 0, 2}, 1.2f), (std::vector<int>{3, 0, 2}));
  EXPECT_EQ(shareOverLevels(10, {0, 0}, 1.2f), (std::vector<int>{0, 0}));
}

TEST(ShareOverLevels, AddsUpToTheTotal) {
  for (int total = 1; total < 200; ++total) {
    const std::vector<int> shares = shareOverLevels(total, {90, 5, 60, 0, 70, 30, 9, 8}, 1.2f);
    ASSERT_EQ(std::accumulate(shares.begin(), shares.end(), 0), total);
  }
}

TEST(SelectSpread, TheShareSpreadDecidesHowManyGoToTheStrongestTexture) {
  const auto strong = [](float share) {
    const std::vector<Corner> selected = selectSpread(gridWithCluster(), 100, {200, 200}, share);
    return std::count_if(selected.begin(), selected.end(),
                         [](const Corner& c) { return c.score == 100; });
  };
  // Spacing 20 px: the rest keeps 20 / 5 = 4 px, of which a row of 15 px has room for 3 at least;
  // spread points keep about half the spacing, room for 2.
  EXPECT_GE(strong(0.0f), 9);
  EXPECT_LE(strong(1.0f), 4);
}

TEST(SelectSpread, FullySpreadPointsKeepTheirDistance) {
  const int count = 40;
  const std::vector<Corner> selected = selectSpread(gridWithCluster(), count, {200, 200}, 1.0f);
  ASSERT_EQ(static_cast<int>(selected.size()), count);
  // The mean spacing is sqrt(200 * 200 / 40) = 31.6 px; square covering reaches half of it.
  for (std::size_t i = 0; i < selected.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_GE(std::max(std::abs(selected[i].x - selected[j].x),
                         std::abs(selected[i].y - selected[j].y)),
                15);
    }
  }
}

TEST(SelectSpread, TheStrongestOfAllIsAlwaysChosenFirst) {
  std::vector<Corner> corners = gridWithCluster();
  corners[17] = corner(corners[17].x, corners[17].y, 200);
  for (const float share : {0.0f, 0.5f, 1.0f}) {
    const Corner first = selectSpread(corners, 30, {200, 200}, share).front();
    EXPECT_EQ(std::make_pair(first.x, first.y), std::make_pair(corners[17].x, corners[17].y));
  }
}

TEST(SelectSpread, FillsTheCountEvenWhereAllCornersCrowd) {
  std::vector<Corner> corners;
  for (int i = 0; i < 100; ++i) {
    corners.push_back(corner(50 + i % 10, 50 + i / 10, 10 + i % 7));
  }
  const std::vector<Corner> selected = selectSpread(corners, 60, {200, 200}, 0.6f);
  std::set<std::pair<int, int>> places;
  for (const Corner& c : selected) {
    places.insert({c.x, c.y});
  }
  EXPECT_EQ(selected.size(), 60U);
  EXPECT_EQ(places.size(), 60U) << "a corner was taken twice";
}

TEST(SelectSpread, FewerCornersThanWantedAreAllTaken) {
  const std::vector<Corner> corners{corner(10, 10, 9), corner(50, 10, 30)};
  EXPECT_EQ(selectSpread(corners, 5, {100, 100}, 0.6f).size(), 2U);
  EXPECT_TRUE(selectSpread({}, 5, {100, 100}, 0.6f).empty());
  EXPECT_TRUE(selectSpread(corners, 0, {100, 100}, 0.6f).empty());
}

}  // namespace
}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#include "flow/flow_selection.hpp"

#include <algorithm>
#include <limits>
#include <set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core/types.hpp>

#include <hmcdyn/types.hpp>

namespace hmcdyn::internal {
namespace {

// 12 x 12 cells of 40 x 30 px.
const cv::Size kImage(480, 360);

/// `count` points in each cell, all of a cell together, at 1 m.
KeyPoints pointsInEachCell(int count) {
  KeyPoints points;
  for (int row = 0; row < 12; ++row) {
    for (int column = 0; column < 12; ++column) {
      for (int k = 0; k < count; ++k) {
        points.push_back(static_cast<float>(40 * column + 5 + k), static_cast<float>(30 * row + 5),
                         1.0f);
      }
    }
  }
  return points;
}

std::pair<int, int> cellOf(const KeyPoints& points, std::size_t i) {
  return {static_cast<int>(points.u[i]) / 40, static_cast<int>(points.v[i]) / 30};
}

TEST(FlowSelection, WithoutABudgetAllAreChosen) {
  const KeyPoints points = pointsInEachCell(2);
  const DetectionBox box{100.0f, 100.0f, 200.0f, 200.0f};
  const FlowSelection all =
      selectForFlow(points.view(), Span<const DetectionBox>(&box, 1), kImage, {10.0f, 0, 0});
  ASSERT_EQ(all.source.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(all.source[i], i);
  }
  EXPECT_EQ(all.points.u, points.u);
  EXPECT_EQ(all.points.v, points.v);
  EXPECT_EQ(all.points.depth, points.depth);
}

TEST(FlowSelection, ABoxAndItsMarginAreChosen) {
  // Given points left, right, above and below a box, just within its margin and just outside
  KeyPoints points;
  points.push_back(60.0f, 150.0f, 1.0f);
  points.push_back(59.0f, 150.0f, 1.0f);
  points.push_back(240.0f, 150.0f, 1.0f);
  points.push_back(241.0f, 150.0f, 1.0f);
  points.push_back(150.0f, 60.0f, 1.0f);
  points.push_back(150.0f, 59.0f, 1.0f);
  points.push_back(150.0f, 240.0f, 1.0f);
  points.push_back(150.0f, 241.0f, 1.0f);
  const DetectionBox box{100.0f, 100.0f, 200.0f, 200.0f};
  const FlowSelection selection =
      selectForFlow(points.view(), Span<const DetectionBox>(&box, 1), kImage, {40.0f, 0, 1});

  // Then the four within are, and one of the others.
  EXPECT_EQ(selection.source, (std::vector<std::size_t>{0, 1, 2, 4, 6}));
}

TEST(FlowSelection, TheFirstOfEachCellComesFirst) {
  const KeyPoints points = pointsInEachCell(3);
  const FlowSelection selection = selectForFlow(points.view(), {}, kImage, {0.0f, 0, 144});
  ASSERT_EQ(selection.source.size(), 144U);
  for (std::size_t k = 0; k < 144; ++k) {
    EXPECT_EQ(selection.source[k], 3 * k);
  }
  // ... then the second of as many cells as are wanted.
  const FlowSelection more = selectForFlow(points.view(), {}, kImage, {0.0f, 0, 200});
  ASSERT_EQ(more.source.size(), 200U);
  EXPECT_EQ(std::count_if(more.source.begin(), more.source.end(),
                          [](std::size_t i) { return i % 3 == 0; }),
            144);
  EXPECT_EQ(std::count_if(more.source.begin(), more.source.end(),
                          [](std::size_t i) { return i % 3 == 1; }),
            56);
}

TEST(FlowSelection, ACrowdedCellTakesNothingFromTheOthers) {
  // Given 500 points in the first cell, and one in ten others
  KeyPoints points;
  for (int k = 0; k < 500; ++k) {
    points.push_back(0.05f * static_cast<float>(k), 3.0f, 1.0f);
  }
  for (int k = 1; k <= 10; ++k) {
    points.push_back(40.0f * static_cast<float>(k) + 1.0f, 33.0f, 1.0f);
  }
  const FlowSelection selection = selectForFlow(points.view(), {}, kImage, {0.0f, 0, 20});
  ASSERT_EQ(selection.source.size(), 20U);
  std::set<std::pair<int, int>> cells;
  for (const std::size_t i : selection.source) {
    cells.insert(cellOf(points, i));
  }
  EXPECT_EQ(cells.size(), 11U);
}

TEST(FlowSelection, BoxesAndBackgroundHaveBudgetsOfTheirOwn) {
  const KeyPoints points = pointsInEachCell(3);
  const DetectionBox left{0.0f, 0.0f, 239.0f, 359.0f};  // six of twelve columns
  const FlowSelection selection =
      selectForFlow(points.view(), Span<const DetectionBox>(&left, 1), kImage, {0.0f, 50, 30});
  const auto in_box = std::count_if(selection.source.begin(), selection.source.end(),
                                    [&](std::size_t i) { return points.u[i] <= 239.0f; });
  EXPECT_EQ(in_box, 50);
  EXPECT_EQ(selection.source.size(), 80U);
  EXPECT_TRUE(std::is_sorted(selection.source.begin(), selection.source.end()));
  for (std::size_t k = 0; k < selection.source.size(); ++k) {
    EXPECT_EQ(selection.points.u[k], points.u[selection.source[k]]);
    EXPECT_EQ(selection.points.v[k], points.v[selection.source[k]]);
  }
}

TEST(FlowSelection, WhereFewerAreThereAllAreTaken) {
  const KeyPoints points = pointsInEachCell(1);
  EXPECT_EQ(selectForFlow(points.view(), {}, kImage, {0.0f, 9, 1000}).source.size(), 144U);
  EXPECT_TRUE(selectForFlow(KeyPoints().view(), {}, kImage, {0.0f, 9, 9}).source.empty());
}

TEST(FlowSelection, WhatIsNotFiniteIsNeverChosen) {
  const float infinity = std::numeric_limits<float>::infinity();
  KeyPoints points;
  points.push_back(kNaN, 5.0f, 1.0f);
  points.push_back(5.0f, infinity, 1.0f);
  points.push_back(5.0f, 5.0f, kNaN);  // depth does not matter
  points.push_back(-1e9f, 1e9f, 1.0f);
  const DetectionBox all{-infinity, -infinity, infinity, infinity};
  for (const int budget : {0, 1, 2, 9}) {
    const FlowSelection inside = selectForFlow(points.view(), Span<const DetectionBox>(&all, 1),
                                               kImage, {0.0f, budget, budget});
    const FlowSelection outside =
        selectForFlow(points.view(), {}, cv::Size(), {0.0f, budget, budget});
    const std::size_t expected = budget == 1 ? 1 : 2;
    EXPECT_EQ(inside.source.size(), expected);
    EXPECT_EQ(outside.source.size(), expected);
    EXPECT_EQ(outside.source[0], 2U);
  }
}

}  // namespace
}  // namespace hmcdyn::internal

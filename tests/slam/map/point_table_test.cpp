// SPDX-License-Identifier: BSD-3-Clause
#include "slam/map/point_table.hpp"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

namespace hmcdyn::slam {
namespace {

MapPoint pointAt(double x) {
  MapPoint point;
  point.position.x() = x;
  point.observations.push_back({1, 2});
  return point;
}

TEST(PointTable, NumbersCountUpAndAreNeverGivenAgain) {
  PointTable table;
  EXPECT_EQ(table.add(pointAt(0.0)), 0);
  EXPECT_EQ(table.add(pointAt(1.0)), 1);
  table.remove(0);
  EXPECT_EQ(table.add(pointAt(2.0)), 2);
  EXPECT_EQ(table.size(), 3U);
  EXPECT_EQ(table.held(), 2U);
  EXPECT_EQ(table[1].position.x(), 1.0);
  EXPECT_EQ(table[2].position.x(), 2.0);
}

TEST(PointTable, ARemovedPointSaysSoAndCannotBeChanged) {
  PointTable table;
  table.add(pointAt(0.0));
  table.remove(0);
  table.remove(0);
  EXPECT_TRUE(table[0].removed);
  EXPECT_TRUE(table[0].observations.empty());
  EXPECT_EQ(table.find(0), nullptr);
  EXPECT_EQ(table.held(), 0U);
}

TEST(PointTable, TheMemoryOfARemovedPointServesTheNext) {
  PointTable table;
  table.add(pointAt(0.0));
  table.add(pointAt(1.0));
  const MapPoint* const first = &table[0];
  table.remove(0);
  table.add(pointAt(2.0));
  EXPECT_EQ(&table[2], first);
  EXPECT_EQ(table[2].observations.size(), 1U);
}

TEST(PointTable, VisitsWhatIsHeldAndIteratesOverAllNumbers) {
  PointTable table;
  for (int i = 0; i < 6; ++i) {
    table.add(pointAt(i));
  }
  table.remove(2);
  table.remove(4);
  table.add(pointAt(6.0));
  EXPECT_EQ(table.where([](const MapPoint& point) { return point.position.x() > 0.5; }),
            (std::vector<int>{1, 3, 5, 6}));
  table.forEach([](MapPoint& point) { point.position.x() += 10.0; });
  EXPECT_EQ(table[6].position.x(), 16.0);
  EXPECT_EQ(table[2].position.x(), 0.0);
  EXPECT_EQ(std::count_if(table.begin(), table.end(), [](const MapPoint& p) { return p.removed; }),
            2);
}

}  // namespace
}  // namespace hmcdyn::slam

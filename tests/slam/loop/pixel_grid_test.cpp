// SPDX-License-Identifier: BSD-3-Clause
#include "slam/loop/pixel_grid.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "random.hpp"

namespace hmcdyn::slam {
namespace {

using hmcdyn::test::Random;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

std::vector<std::size_t> around(const PixelGrid& grid, double u, double v, double radius) {
  std::vector<std::size_t> found;
  grid.around(u, v, radius, [&](std::size_t i) { found.push_back(i); });
  std::sort(found.begin(), found.end());
  return found;
}

TEST(PixelGrid, FindsWhatASearchThroughAllFinds) {
  Random random(1);
  KeyPoints points;
  for (int i = 0; i < 500; ++i) {
    const float u = random.uniformFloat(0.0f, 640.0f);
    points.push_back(u, random.uniformFloat(0.0f, 480.0f), 1.0f);
  }
  for (const double cell : {3.0, 12.0, 1000.0}) {
    const PixelGrid grid(points, cell);
    for (int k = 0; k < 200; ++k) {
      const double u = random.uniform(20.0, 620.0);
      const double v = random.uniform(20.0, 460.0);
      const double radius = random.uniform(0.5, 40.0);
      std::vector<std::size_t> expected;
      for (std::size_t i = 0; i < points.size(); ++i) {
        if (std::hypot(points.u[i] - u, points.v[i] - v) <= radius) {
          expected.push_back(i);
        }
      }
      EXPECT_EQ(around(grid, u, v, radius), expected);
    }
  }
}

TEST(PixelGrid, CoversTheBoxAroundItsPoints) {
  KeyPoints points;
  points.push_back(100.0f, 50.0f, 1.0f);
  points.push_back(300.0f, 200.0f, 0.0f);  // with or without depth
  const PixelGrid grid(points, 10.0);
  EXPECT_TRUE(grid.covers(100.0, 50.0));
  EXPECT_TRUE(grid.covers(300.0, 200.0));
  EXPECT_TRUE(grid.covers(200.0, 100.0));
  EXPECT_FALSE(grid.covers(99.9, 100.0));
  EXPECT_FALSE(grid.covers(200.0, 200.1));
  EXPECT_FALSE(grid.covers(kNan, 100.0));
  EXPECT_EQ(around(grid, 100.0, 50.0, 1.0), (std::vector<std::size_t>{0}));
  EXPECT_EQ(around(grid, 300.0, 200.0, 0.0), (std::vector<std::size_t>{1}));
}

TEST(PixelGrid, OfNoPointsCoversNothing) {
  EXPECT_FALSE(PixelGrid({}, 10.0).covers(0.0, 0.0));
  KeyPoints points;
  points.push_back(kNan, 3.0f, 1.0f);
  points.push_back(3.0f, std::numeric_limits<float>::infinity(), 1.0f);
  EXPECT_FALSE(PixelGrid(points, 10.0).covers(3.0, 3.0));
}

// A pixel that bad data puts far off: the grid grows coarser, not larger.
TEST(PixelGrid, AnAbsurdPixelCostsNoMemoryAndHidesNothing) {
  KeyPoints points;
  points.push_back(10.0f, 10.0f, 1.0f);
  points.push_back(14.0f, 10.0f, 1.0f);
  points.push_back(1e30f, -1e30f, 1.0f);
  const PixelGrid grid(points, 8.0);
  EXPECT_EQ(around(grid, 11.0, 10.0, 5.0), (std::vector<std::size_t>{0, 1}));
}

}  // namespace
}  // namespace hmcdyn::slam

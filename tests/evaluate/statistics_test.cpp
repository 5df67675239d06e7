// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/statistics.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace hmcdyn::evaluate {
namespace {

TEST(Statistics, OfFourValuesByHand) {
  const std::vector<double> values{3.0, 1.0, 2.0, 4.0};
  const Statistics statistics = computeStatistics(values);
  EXPECT_DOUBLE_EQ(statistics.rmse, std::sqrt(30.0 / 4.0));
  EXPECT_DOUBLE_EQ(statistics.mean, 2.5);
  EXPECT_DOUBLE_EQ(statistics.median, 2.5);
  EXPECT_DOUBLE_EQ(statistics.std, std::sqrt(5.0 / 4.0));
  EXPECT_DOUBLE_EQ(statistics.min, 1.0);
  EXPECT_DOUBLE_EQ(statistics.max, 4.0);
  EXPECT_EQ(statistics.count, 4U);
}

TEST(Statistics, MedianOfAnOddCountIsTheMiddleValue) {
  EXPECT_DOUBLE_EQ(median(std::vector<double>{9.0, -1.0, 2.0}), 2.0);
}

TEST(Statistics, OfOneValue) {
  const Statistics statistics = computeStatistics(std::vector<double>{-2.0});
  EXPECT_DOUBLE_EQ(statistics.rmse, 2.0);
  EXPECT_DOUBLE_EQ(statistics.median, -2.0);
  EXPECT_DOUBLE_EQ(statistics.std, 0.0);
}

TEST(Statistics, RefuseNothingAndNaN) {
  EXPECT_THROW(computeStatistics({}), std::invalid_argument);
  EXPECT_THROW(median({}), std::invalid_argument);
  const std::vector<double> values{1.0, std::numeric_limits<double>::quiet_NaN()};
  EXPECT_THROW(computeStatistics(values), std::invalid_argument);
}

}  // namespace
}  // namespace hmcdyn::evaluate

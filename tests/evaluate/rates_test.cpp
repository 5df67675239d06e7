// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/rates.hpp"

#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

namespace hmcdyn::evaluate {
namespace {

TEST(TrackingRate, IsTheShareInPerCent) {
  EXPECT_DOUBLE_EQ(trackingRate(3, 4), 75.0);
  EXPECT_DOUBLE_EQ(trackingRate(0, 4), 0.0);
  EXPECT_DOUBLE_EQ(trackingRate(4, 4), 100.0);
}

TEST(TrackingRate, RefusesNoFramesAndMoreTrackedThanThereAre) {
  EXPECT_THROW(trackingRate(0, 0), std::invalid_argument);
  EXPECT_THROW(trackingRate(5, 4), std::invalid_argument);
}

TEST(Improvement, IsRelativeToTheBaseline) {
  EXPECT_DOUBLE_EQ(improvement(0.2, 0.05), 75.0);
  EXPECT_DOUBLE_EQ(improvement(0.2, 0.2), 0.0);
  EXPECT_DOUBLE_EQ(improvement(0.2, 0.3), -50.0);
  EXPECT_DOUBLE_EQ(improvement(0.2, 0.0), 100.0);
}

TEST(Improvement, RefusesABaselineThatCannotBeImproved) {
  EXPECT_THROW(improvement(0.0, 0.1), std::invalid_argument);
  EXPECT_THROW(improvement(-0.1, 0.1), std::invalid_argument);
  EXPECT_THROW(improvement(std::numeric_limits<double>::quiet_NaN(), 0.1), std::invalid_argument);
}

}  // namespace
}  // namespace hmcdyn::evaluate

// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include <hmcdyn/depth_error.hpp>

namespace {

hmcdyn::DepthErrorModel model() { return {0.001f, 0.002f, 0.01f, 0.005f, 0.3f}; }

std::string messageFor(const hmcdyn::DepthErrorModel& wrong) {
  try {
    hmcdyn::checkModel(wrong);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(DepthError, NoiseGrowsWithTheSquareOfTheDepth) {
  EXPECT_NEAR(hmcdyn::depthNoise(2.0, model()), 0.001 + 0.002 * 4.0, 1e-9);
}

TEST(DepthError, SystematicErrorHasAShareAndASquare) {
  EXPECT_NEAR(hmcdyn::systematicDepthError(3.0, model()), 0.01 * 3.0 + 0.005 * 9.0, 1e-8);
}

TEST(DepthError, BothPartsAddAsVariances) {
  // Noise 0.003 m at 1 m; the systematic part is set to 0.004 m: 3, 4, 5.
  const hmcdyn::DepthErrorModel triangle{0.001f, 0.002f, 0.004f, 0.0f, 1.0f};
  EXPECT_NEAR(hmcdyn::depthError(1.0, triangle), 0.005, 1e-8);
}

TEST(DepthError, ViewsOfOnePointShareTheSystematicErrorButForAPart) {
  // Noise 3 mm; systematic 40 mm at 1 m, a tenth of it not shared: 4 mm. Together 5 mm.
  const hmcdyn::DepthErrorModel half{0.001f, 0.002f, 0.04f, 0.0f, 0.1f};
  EXPECT_NEAR(hmcdyn::relativeDepthError(1.0, half), 0.005, 1e-8);
  // Four depths that are wrong alike say what one says: the variance of that part times four.
  EXPECT_NEAR(hmcdyn::relativeDepthError(1.0, half, 4.0), std::hypot(0.003, 0.008), 1e-8);
}

TEST(DepthError, ABadFieldIsNamed) {
  hmcdyn::DepthErrorModel negative = model();
  negative.systematic_quadratic = -0.01f;
  EXPECT_NE(messageFor(negative).find("systematic_quadratic is -0.01"), std::string::npos);
  hmcdyn::DepthErrorModel not_a_number = model();
  not_a_number.noise_floor = std::numeric_limits<float>::quiet_NaN();
  EXPECT_NE(messageFor(not_a_number).find("noise_floor is nan"), std::string::npos);
}

TEST(DepthError, NoiseCannotBeZeroEverywhere) {
  EXPECT_NE(messageFor({0.0f, 0.0f, 0.01f, 0.0f, 0.3f}).find("noise_floor"), std::string::npos);
  EXPECT_EQ(messageFor({0.0f, 0.001f, 0.0f, 0.0f, 0.3f}), "");
}

}  // namespace

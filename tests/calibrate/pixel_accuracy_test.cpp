// SPDX-License-Identifier: BSD-3-Clause
#include "calibrate/pixel_accuracy.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace hmcdyn::calibrate {
namespace {

TEST(PixelAccuracy, EachSizeHasItsOwnWhateverTheWrongMatchesSay) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::vector<PixelResidual> residuals;
  for (int i = 0; i < 8000; ++i) {
    const bool large = i % 2 == 1;
    const double deviation = large ? 0.8 : 0.1;
    const double distance = std::hypot(deviation * normal(random), deviation * normal(random));
    residuals.push_back({large ? 20.0f : 3.0f, i % 10 < 2 ? 30.0 + i : distance});
  }
  const std::vector<double> found = pixelDeviations(residuals, 1.0, 0.01);
  ASSERT_EQ(found.size(), residuals.size());
  // A fifth of wrong matches moves the median to the 62nd percentile of the right ones.
  EXPECT_NEAR(found[2], 0.1, 0.025);
  EXPECT_NEAR(found[3], 0.8, 0.2);
}

TEST(PixelAccuracy, ResidualsOfASolutionAreSmallerThanTheErrorsAndNothingIsExact) {
  const std::vector<PixelResidual> residuals(80, PixelResidual{3.0f, 0.2});
  EXPECT_NEAR(pixelDeviations(residuals, 0.25, 0.01)[0],
              2.0 * pixelDeviations(residuals, 1.0, 0.01)[0], 1e-12);
  const std::vector<PixelResidual> exact(80, PixelResidual{3.0f, 0.0});
  EXPECT_EQ(pixelDeviations(exact, 1.0, 0.05)[40], 0.05);
  EXPECT_TRUE(pixelDeviations({}, 1.0, 0.05).empty());
}

}  // namespace
}  // namespace hmcdyn::calibrate

// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include <hmcdyn/steps/weights.hpp>

#include "constants.hpp"
#include "invalid_argument.hpp"
#include "random.hpp"

namespace hmcdyn {
namespace {

using test::kInfinity;

WeightOptions options() {
  WeightOptions result;
  result.without_depth = 0.25f;
  result.without_anchor = 0.75f;
  return result;
}

TEST(Weights, FollowTheGaussian) {
  // Given an anchor at 2 m with a deviation of 0.5 m, eq. 7-8 at 0, 1, 2 and 3 deviations.
  const DepthAnchor anchor{2.0f, 0.5f};
  EXPECT_FLOAT_EQ(keptPointWeight(2.0f, anchor, options()), 0.0f);
  EXPECT_NEAR(keptPointWeight(2.5f, anchor, options()), 1.0 - std::exp(-0.5), 1e-6);
  EXPECT_NEAR(keptPointWeight(1.5f, anchor, options()), 0.3934693, 1e-6);
  EXPECT_NEAR(keptPointWeight(3.0f, anchor, options()), 1.0 - std::exp(-2.0), 1e-6);
  EXPECT_NEAR(keptPointWeight(3.5f, anchor, options()), 0.9888910, 1e-6);
  EXPECT_NEAR(depthSimilarity(2.5f, anchor), 0.6065307, 1e-6);
}

TEST(Weights, GrowWithTheDistanceFromTheAnchor) {
  test::Random random(5);
  for (int trial = 0; trial < 1000; ++trial) {
    const DepthAnchor anchor{random.uniformFloat(0.5, 8.0), random.uniformFloat(0.0, 2.0)};
    float near = random.uniformFloat(0.1, 10.0);
    float far = random.uniformFloat(0.1, 10.0);
    if (std::abs(near - anchor.depth) > std::abs(far - anchor.depth)) {
      std::swap(near, far);
    }
    EXPECT_LE(keptPointWeight(near, anchor, options()), keptPointWeight(far, anchor, options()))
        << near << " m and " << far << " m from " << anchor.depth << " m, " << anchor.sigma;
  }
}

TEST(Weights, WithoutDeviationTakeTheLimit) {
  const DepthAnchor anchor{2.0f, 0.0f};
  EXPECT_EQ(keptPointWeight(2.0f, anchor, options()), 0.0f);
  EXPECT_EQ(keptPointWeight(2.001f, anchor, options()), 1.0f);
}

TEST(Weights, WithoutAnAnchorAreTheOptions) {
  EXPECT_EQ(keptPointWeight(2.0f, DepthAnchor{}, options()), 0.75f);
  EXPECT_EQ(keptPointWeight(0.0f, DepthAnchor{kNaN, 1.0f}, options()), 0.75f);
}

TEST(Weights, WithoutDepthAreTheOptions) {
  for (const float none : {0.0f, -1.0f, kNaN, kInfinity}) {
    EXPECT_EQ(keptPointWeight(none, DepthAnchor{2.0f, 0.5f}, options()), 0.25f) << none;
  }
}

TEST(Weights, AreWithinZeroAndOneForEveryInput) {
  const std::vector<float> special{0.0f,  -0.0f,   1.0f,     -1.0f,     1e-45f,     1e-38f, 1e-20f,
                                   1e20f, 3.4e38f, -3.4e38f, kInfinity, -kInfinity, kNaN};
  for (const float depth : special) {
    for (const float anchor : special) {
      for (const float sigma : special) {
        const float weight = keptPointWeight(depth, {anchor, sigma}, options());
        EXPECT_TRUE(weight >= 0.0f && weight <= 1.0f)
            << weight << " at " << depth << " m, anchor " << anchor << " m, sigma " << sigma;
      }
    }
  }
}

TEST(Weights, OfManyPointsAreThoseOfEach) {
  test::Random random(11);
  for (std::size_t n = 0; n <= 40; ++n) {
    const DepthAnchor anchor{random.uniformFloat(0.5, 5.0), random.uniformFloat(0.01, 2.0)};
    std::vector<float> depth;
    for (std::size_t i = 0; i < n; ++i) {
      depth.push_back(i % 7 == 3 ? kNaN : random.uniformFloat(-0.5, 9.0));
    }
    const std::vector<float> weight = keptPointWeights(depth, anchor, options(), {9.0f});
    ASSERT_EQ(weight.size(), n);
    for (std::size_t i = 0; i < n; ++i) {
      EXPECT_NEAR(weight[i], keptPointWeight(depth[i], anchor, options()), 1e-6f)
          << depth[i] << " m, anchor " << anchor.depth << " m, sigma " << anchor.sigma << " m";
    }
    std::reverse(depth.begin(), depth.end());
    std::vector<float> turned = keptPointWeights(depth, anchor, options());
    std::reverse(turned.begin(), turned.end());
    EXPECT_EQ(turned, weight) << "the same wherever a point stands, " << n << " points";
  }
}

TEST(Weights, OfManyPointsAreWithinZeroAndOneForEveryInput) {
  const std::vector<float> special{0.0f,  -0.0f,   1.0f,     -1.0f,     1e-45f,     1e-38f, 1e-20f,
                                   1e20f, 3.4e38f, -3.4e38f, kInfinity, -kInfinity, kNaN};
  for (const float anchor : special) {
    for (const float sigma : special) {
      const std::vector<float> weight = keptPointWeights(special, {anchor, sigma}, options());
      for (std::size_t i = 0; i < special.size(); ++i) {
        EXPECT_NEAR(weight[i], keptPointWeight(special[i], {anchor, sigma}, options()), 1e-6f)
            << special[i] << " m, anchor " << anchor << " m, sigma " << sigma << " m";
      }
    }
  }
}

TEST(Weights, OptionsOutOfRangeAreNamed) {
  const auto message = [](float without_depth, float without_anchor) {
    WeightOptions changed;
    changed.without_depth = without_depth;
    changed.without_anchor = without_anchor;
    return test::invalidArgumentOf([&] { checkOptions(changed); });
  };
  EXPECT_EQ(message(-0.1f, 0.5f),
            "WeightOptions::without_depth is -0.100000; expected a weight in [0, 1]");
  EXPECT_EQ(message(0.5f, kNaN),
            "WeightOptions::without_anchor is nan; expected a weight in [0, 1]");
  EXPECT_EQ(message(0.0f, 1.0f), "nothing thrown");
}

TEST(UseSoftWeights, OpensAboveTheGateAndNotAtIt) {
  EXPECT_FALSE(useSoftWeights(3, 5));
  EXPECT_FALSE(useSoftWeights(600, 1000));
  EXPECT_TRUE(useSoftWeights(601, 1000));
  EXPECT_FALSE(useSoftWeights(0, 1000));
  EXPECT_TRUE(useSoftWeights(1000, 1000));
  EXPECT_TRUE(useSoftWeights(1, 1000, 0.0));
  EXPECT_FALSE(useSoftWeights(1000, 1000, 1.0));
}

TEST(UseSoftWeights, IsExactAtTheGateForEveryNumberOfPoints) {
  for (std::size_t fifths = 1; fifths <= 2000; ++fifths) {
    ASSERT_FALSE(useSoftWeights(3 * fifths, 5 * fifths)) << fifths;
    ASSERT_TRUE(useSoftWeights(3 * fifths + 1, 5 * fifths)) << fifths;
  }
}

TEST(UseSoftWeights, NoPointsNeedNone) { EXPECT_FALSE(useSoftWeights(0, 0)); }

TEST(UseSoftWeights, RefusesMorePointsInBoxesThanPointsAndOddGates) {
  EXPECT_THROW(useSoftWeights(6, 5), std::invalid_argument);
  EXPECT_THROW(useSoftWeights(3, 5, -0.1), std::invalid_argument);
  EXPECT_THROW(useSoftWeights(3, 5, 1.1), std::invalid_argument);
  EXPECT_THROW(useSoftWeights(3, 5, kNaN), std::invalid_argument);
}

TEST(HardWeights, KeepZeroAndRaiseTheRest) {
  const std::vector<float> soft{0.0f, 1e-30f, 0.3f, 1.0f};
  EXPECT_EQ(hardWeights(soft), (std::vector<float>{0.0f, 1.0f, 1.0f, 1.0f}));
  EXPECT_TRUE(hardWeights({}).empty());
}

TEST(HardWeights, RefuseWhatIsNoWeight) {
  EXPECT_THROW(hardWeights(std::vector<float>{0.5f, -0.1f}), std::invalid_argument);
  EXPECT_THROW(hardWeights(std::vector<float>{kNaN}), std::invalid_argument);
}

}  // namespace
}  // namespace hmcdyn

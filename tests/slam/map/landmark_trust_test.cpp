// SPDX-License-Identifier: BSD-3-Clause
#include "slam/map/landmark_trust.hpp"

#include <gtest/gtest.h>

namespace hmcdyn::slam {
namespace {

constexpr LandmarkSighting kStatic{PointLabel::kStatic, 1.0f, true};
constexpr LandmarkSighting kDynamic{PointLabel::kDynamic, 0.0f, true};

TEST(LandmarkTrust, AddsUpLogOdds) {
  const LandmarkTrustOptions options;
  LandmarkTrust trust{options.prior};
  trust.update(kStatic, options);                             // 0.5 + 0.4
  trust.update({PointLabel::kSuspect, 0.5f, true}, options);  // + 0.4 * 0.5
  trust.update({PointLabel::kStatic, 1.0f, false}, options);  // not seen: nothing
  trust.update(kDynamic, options);                            // - 0.8
  EXPECT_NEAR(trust.log_odds, 0.3, 1e-12);
  EXPECT_NEAR(trust.probability(), 1.0 / (1.0 + std::exp(-0.3)), 1e-12);
}

TEST(LandmarkTrust, AWallThatIsMisjudgedOnceStays) {
  const LandmarkTrustOptions options;
  LandmarkTrust trust{options.prior};
  for (int k = 0; k < 4; ++k) {
    trust.update(kStatic, options);
  }
  trust.update(kDynamic, options);
  EXPECT_GT(trust.log_odds, options.removal);
  trust.update(kStatic, options);
  EXPECT_GT(trust.log_odds, options.threshold);
}

TEST(LandmarkTrust, ANewPointThatMovesTwiceIsRemoved) {
  const LandmarkTrustOptions options;
  LandmarkTrust trust{options.prior};
  trust.update(kDynamic, options);
  EXPECT_GT(trust.log_odds, options.removal);
  trust.update(kDynamic, options);
  EXPECT_LT(trust.log_odds, options.removal);
}

TEST(LandmarkTrust, ANewPointIsNotTrustedAtOnce) {
  const LandmarkTrustOptions options;
  LandmarkTrust trust{options.prior};
  EXPECT_LT(trust.log_odds, options.threshold);
  trust.update(kStatic, options);
  EXPECT_LT(trust.log_odds, options.threshold) << "once is a pause";
  trust.update(kStatic, options);
  EXPECT_GE(trust.log_odds, options.threshold);
}

TEST(LandmarkTrust, AThingThatStoodLongIsStillFoundOut) {
  const LandmarkTrustOptions options;
  LandmarkTrust trust{options.prior};
  for (int k = 0; k < 1000; ++k) {
    trust.update(kStatic, options);
  }
  int sightings = 0;
  while (trust.log_odds >= options.removal) {
    trust.update(kDynamic, options);
    ++sightings;
  }
  EXPECT_EQ(sightings, 6);  // from the limit of 4 in steps of 0.8 below -0.7
}

}  // namespace
}  // namespace hmcdyn::slam

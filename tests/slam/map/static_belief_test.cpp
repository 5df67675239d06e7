// SPDX-License-Identifier: BSD-3-Clause
#include "slam/map/static_belief.hpp"

#include <gtest/gtest.h>

namespace hmcdyn::slam {
namespace {

constexpr StaticEvidence kStatic{PointLabel::kStatic, 1.0f, true};
constexpr StaticEvidence kDynamic{PointLabel::kDynamic, 0.0f, true};

TEST(StaticBelief, AddsUpLogOdds) {
  const StaticBeliefOptions options;
  StaticBelief belief{options.prior};
  belief.update(kStatic, options);                             // 0.5 + 0.4
  belief.update({PointLabel::kSuspect, 0.5f, true}, options);  // + 0.4 * 0.5
  belief.update({PointLabel::kStatic, 1.0f, false}, options);  // not seen: nothing
  belief.update(kDynamic, options);                            // - 0.8
  EXPECT_NEAR(belief.log_odds, 0.3, 1e-12);
  EXPECT_NEAR(belief.probability(), 1.0 / (1.0 + std::exp(-0.3)), 1e-12);
}

TEST(StaticBelief, AWallThatIsMisjudgedOnceStays) {
  const StaticBeliefOptions options;
  StaticBelief belief{options.prior};
  for (int k = 0; k < 4; ++k) {
    belief.update(kStatic, options);
  }
  belief.update(kDynamic, options);
  EXPECT_GT(belief.log_odds, options.removal);
  belief.update(kStatic, options);
  EXPECT_GT(belief.log_odds, options.trust);
}

TEST(StaticBelief, ANewPointThatMovesTwiceIsRemoved) {
  const StaticBeliefOptions options;
  StaticBelief belief{options.prior};
  belief.update(kDynamic, options);
  EXPECT_GT(belief.log_odds, options.removal);
  belief.update(kDynamic, options);
  EXPECT_LT(belief.log_odds, options.removal);
}

TEST(StaticBelief, ANewPointIsNotTrustedAtOnce) {
  const StaticBeliefOptions options;
  StaticBelief belief{options.prior};
  EXPECT_LT(belief.log_odds, options.trust);
  belief.update(kStatic, options);
  EXPECT_LT(belief.log_odds, options.trust) << "once is a pause";
  belief.update(kStatic, options);
  EXPECT_GE(belief.log_odds, options.trust);
}

TEST(StaticBelief, AThingThatStoodLongIsStillFoundOut) {
  const StaticBeliefOptions options;
  StaticBelief belief{options.prior};
  for (int k = 0; k < 1000; ++k) {
    belief.update(kStatic, options);
  }
  int sightings = 0;
  while (belief.log_odds >= options.removal) {
    belief.update(kDynamic, options);
    ++sightings;
  }
  EXPECT_EQ(sightings, 6);  // from the limit of 4 in steps of 0.8 below -0.7
}

}  // namespace
}  // namespace hmcdyn::slam

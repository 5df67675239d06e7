// SPDX-License-Identifier: BSD-3-Clause
// Which matches speak for the camera: the background, what is known to be at
// rest, what is not known to move, or all.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include <hmcdyn/steps/fundamental.hpp>

#include "invalid_argument.hpp"
#include "motion_model_settings.hpp"
#include "two_view_scene.hpp"

namespace hmcdyn {
namespace {

using test::fixedTwoViewOptions;
using test::makeScene;
using test::motionOf;
using test::TwoViewScene;

TwoViewScene sceneOf(std::size_t points, std::uint32_t seed = 1) {
  return makeScene(motionOf({0.2, -0.5, 0.1}, {0.1, 0.02, 0.03}), test::noisy(seed, points));
}

const std::vector<DetectionBox> kWholeImage{{-50.0f, -50.0f, 800.0f, 600.0f, kPersonClassId, 1.0f}};

/// Two of three points rise together by 8 px, as a crowd does that walks.
struct Crowd {
  TwoViewScene scene;
  std::vector<KnownMotion> known;
  std::size_t at_rest = 0;

  explicit Crowd(std::uint32_t seed) : scene(sceneOf(300, seed)) {
    for (std::size_t i = 0; i < scene.size(); ++i) {
      known.push_back(i % 3 != 0 ? KnownMotion::kMoving : KnownMotion::kAtRest);
      at_rest += i % 3 != 0 ? 0 : 1;
      if (i % 3 != 0) {
        scene.moveCurrent(i, {0.0, -8.0});
      }
    }
  }

  /// The share of those points within 1 px of their lines.
  double shareOnLines(const TwoViewModel& model, KnownMotion of) const {
    const std::vector<float> distance = modelDistances(model, scene.pairs());
    std::size_t near = 0;
    std::size_t all = 0;
    for (std::size_t i = 0; i < scene.size(); ++i) {
      if (known[i] == of) {
        ++all;
        near += distance[i] < 1.0f ? 1 : 0;
      }
    }
    return static_cast<double>(near) / static_cast<double>(all);
  }
  TwoViewEstimate estimate(const std::vector<KnownMotion>& knowing,
                           const TwoViewOptions& options = fixedTwoViewOptions()) const {
    return estimateTwoViewModel(scene.pairs(), kWholeImage, knowing, options);
  }
};

TEST(MatchSource, ABackgroundThatIsTooSmallGivesAllPoints) {
  // Given a box that leaves a strip at the left, of four cells at most
  const TwoViewScene scene = sceneOf(200);
  const std::vector<DetectionBox> box{{60.0f, -20.0f, 700.0f, 500.0f, kPersonClassId, 1.0f}};
  const auto outside = static_cast<std::size_t>(std::count_if(
      scene.current_u.begin(), scene.current_u.end(), [](float u) { return u < 60.0f; }));
  ASSERT_GE(outside, 12U);
  ASSERT_LT(outside, 60U);

  // Then it is too few points ...
  TwoViewOptions options = fixedTwoViewOptions();
  const TwoViewEstimate few = estimateTwoViewModel(scene.pairs(), box, options);
  EXPECT_EQ(few.source, MatchSource::kAll);
  EXPECT_EQ(few.matches, 200U);

  // ... or enough ...
  options.min_background_matches = static_cast<int>(outside);
  options.min_background_cells = 3;
  const TwoViewEstimate strip = estimateTwoViewModel(scene.pairs(), box, options);
  EXPECT_EQ(strip.source, MatchSource::kBackground);
  EXPECT_EQ(strip.matches, outside);
  EXPECT_TRUE(backgroundSuffices(scene.pairs(), box, options));

  // ... in too few cells.
  options.min_background_cells = 5;
  EXPECT_EQ(estimateTwoViewModel(scene.pairs(), box, options).source, MatchSource::kAll);
  EXPECT_FALSE(backgroundSuffices(scene.pairs(), box, options));
}

TEST(MatchSource, ABoxThatHoldsNothingLeavesAllOfTheBackground) {
  const TwoViewScene scene = sceneOf(200);
  const std::vector<DetectionBox> inverted{{600.0f, 400.0f, 10.0f, 10.0f, kPersonClassId, 1.0f}};
  EXPECT_TRUE(backgroundSuffices(scene.pairs(), inverted, fixedTwoViewOptions()));
  const TwoViewEstimate found =
      estimateTwoViewModel(scene.pairs(), inverted, fixedTwoViewOptions());
  EXPECT_EQ(found.source, MatchSource::kBackground);
  EXPECT_EQ(found.matches, 200U);
}

TEST(MatchSource, ACrowdThatIsKnownToMoveIsNotTakenForTheWorld) {
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    const Crowd crowd(seed);
    // Where nothing is known the many are the world ...
    const TwoViewEstimate fooled = crowd.estimate({});
    EXPECT_EQ(fooled.source, MatchSource::kAll);
    EXPECT_EQ(fooled.matches, 300U);
    EXPECT_LT(crowd.shareOnLines(fooled.model, KnownMotion::kAtRest), 0.5) << "seed " << seed;

    // ... else they are not.
    const TwoViewEstimate found = crowd.estimate(crowd.known);
    EXPECT_EQ(found.source, MatchSource::kAtRest);
    EXPECT_EQ(found.matches, crowd.at_rest);
    EXPECT_EQ(found.verdict, FundamentalVerdict::kDefined);
    EXPECT_GT(crowd.shareOnLines(found.model, KnownMotion::kAtRest), 0.95) << "seed " << seed;
    EXPECT_LT(crowd.shareOnLines(found.model, KnownMotion::kMoving), 0.1) << "seed " << seed;
  }
}

TEST(MatchSource, WhatHasJustAppearedDoesNotSpeakWhileOthersDo) {
  // Given a crowd of which half has just stepped out from behind something
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    Crowd crowd(seed);
    std::vector<KnownMotion> known = crowd.known;
    std::size_t unknown = 0;
    for (std::size_t i = 0; i < known.size(); i += 2) {
      if (known[i] == KnownMotion::kMoving) {
        known[i] = KnownMotion::kUnknown;
        ++unknown;
      }
    }
    ASSERT_EQ(unknown, 100U);
    const TwoViewEstimate found = crowd.estimate(known);
    EXPECT_EQ(found.source, MatchSource::kAtRest);
    EXPECT_EQ(found.matches, crowd.at_rest);
    EXPECT_LT(crowd.shareOnLines(found.model, KnownMotion::kMoving), 0.1) << "seed " << seed;

    // Where too little is known to be at rest, the unknown speak, too.
    TwoViewOptions options = fixedTwoViewOptions();
    options.min_background_matches = 101;
    const TwoViewEstimate short_of = crowd.estimate(known, options);
    EXPECT_EQ(short_of.source, MatchSource::kNotMoving);
    EXPECT_EQ(short_of.matches, crowd.at_rest + unknown);
  }
}

TEST(MatchSource, EnoughBackgroundNeedsNoMemory) {
  const Crowd crowd(1);
  const TwoViewEstimate with =
      estimateTwoViewModel(crowd.scene.pairs(), {}, crowd.known, fixedTwoViewOptions());
  const TwoViewEstimate without =
      estimateTwoViewModel(crowd.scene.pairs(), {}, fixedTwoViewOptions());
  EXPECT_EQ(with.source, MatchSource::kBackground);
  EXPECT_EQ(with.model.matrix, without.model.matrix);
}

TEST(MatchSource, TooLittleAtRestGivesAllPoints) {
  const Crowd crowd(1);
  TwoViewOptions options = fixedTwoViewOptions();
  // Too few: 100 of 300 are at rest.
  ASSERT_EQ(crowd.at_rest, 100U);
  options.min_background_matches = 101;
  EXPECT_EQ(crowd.estimate(crowd.known, options).source, MatchSource::kAll);
  options.min_background_matches = 100;
  EXPECT_EQ(crowd.estimate(crowd.known, options).source, MatchSource::kAtRest);

  // In too few cells: only what lies in the upper left quarter is at rest, which is four cells.
  std::vector<KnownMotion> quarter;
  for (std::size_t i = 0; i < crowd.scene.size(); ++i) {
    const bool in = crowd.scene.current_u[i] < 300.0f && crowd.scene.current_v[i] < 220.0f;
    quarter.push_back(in ? KnownMotion::kAtRest : KnownMotion::kMoving);
  }
  options.min_background_matches = 12;
  EXPECT_EQ(crowd.estimate(quarter, options).source, MatchSource::kAll);
  options.min_background_cells = 4;
  EXPECT_EQ(crowd.estimate(quarter, options).source, MatchSource::kAtRest);
}

TEST(MatchSource, KnowledgeOfAnotherSizeIsRefused) {
  const TwoViewScene scene = sceneOf(20);
  const std::vector<KnownMotion> known(19, KnownMotion::kAtRest);
  EXPECT_EQ(test::invalidArgumentOf(
                [&] { estimateTwoViewModel(scene.pairs(), {}, known, fixedTwoViewOptions()); }),
            "estimateTwoViewModel: known has 19 elements; expected none, or one for each of the 20 "
            "pairs");
}

}  // namespace
}  // namespace hmcdyn

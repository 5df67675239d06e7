// SPDX-License-Identifier: BSD-3-Clause
// Which matches speak for the camera: the background, what is not known to move, or all.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include <hmcdyn/fundamental.hpp>

#include "invalid_argument.hpp"
#include "two_view_scene.hpp"

namespace hmcdyn {
namespace {

using test::makeScene;
using test::motionOf;
using test::SceneSettings;
using test::TwoViewScene;

MotionModelOptions fixedOptions() {
  MotionModelOptions options;
  options.min_matches = 12;
  options.min_background_matches = 60;
  options.min_background_cells = 5;
  options.inlier_threshold = 0.5f;
  return options;
}

TwoViewScene sceneOf(std::size_t points, std::uint32_t seed = 1) {
  SceneSettings settings;
  settings.points = points;
  settings.noise = 0.15;
  settings.seed = seed;
  return makeScene(motionOf({0.2, -0.5, 0.1}, {0.1, 0.02, 0.03}), settings);
}

const std::vector<DetectionBox> kWholeImage{{-50.0f, -50.0f, 800.0f, 600.0f, kPersonClassId, 1.0f}};

/// Two of three points rise together by 8 px, as a crowd does that walks.
struct Crowd {
  TwoViewScene scene;
  std::vector<std::uint8_t> moving;
  std::size_t at_rest = 0;

  explicit Crowd(std::uint32_t seed) : scene(sceneOf(300, seed)), moving(scene.size(), 0) {
    for (std::size_t i = 0; i < scene.size(); ++i) {
      moving[i] = i % 3 != 0 ? 1 : 0;
      at_rest += moving[i] == 0 ? 1 : 0;
      if (moving[i] != 0) {
        scene.moveCurrent(i, {0.0, -8.0});
      }
    }
  }

  /// The share of the points at rest, or of the others, within 1 px of their lines.
  double shareOnLines(const TwoViewModel& model, bool of_moving) const {
    const std::vector<float> distance = modelDistances(model, scene.pairs());
    std::size_t near = 0;
    for (std::size_t i = 0; i < scene.size(); ++i) {
      near += (moving[i] != 0) == of_moving && distance[i] < 1.0f ? 1 : 0;
    }
    const std::size_t of = of_moving ? scene.size() - at_rest : at_rest;
    return static_cast<double>(near) / static_cast<double>(of);
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
  MotionModelOptions options = fixedOptions();
  const MotionModelEstimate few = estimateMotionModel(scene.pairs(), box, options);
  EXPECT_EQ(few.source, MatchSource::kAll);
  EXPECT_EQ(few.matches, 200U);

  // ... or enough ...
  options.min_background_matches = static_cast<int>(outside);
  options.min_background_cells = 3;
  const MotionModelEstimate strip = estimateMotionModel(scene.pairs(), box, options);
  EXPECT_EQ(strip.source, MatchSource::kBackground);
  EXPECT_EQ(strip.matches, outside);
  EXPECT_TRUE(backgroundSuffices(scene.pairs(), box, options));

  // ... in too few cells.
  options.min_background_cells = 5;
  EXPECT_EQ(estimateMotionModel(scene.pairs(), box, options).source, MatchSource::kAll);
  EXPECT_FALSE(backgroundSuffices(scene.pairs(), box, options));
}

TEST(MatchSource, ABoxThatHoldsNothingLeavesAllOfTheBackground) {
  const TwoViewScene scene = sceneOf(200);
  const std::vector<DetectionBox> inverted{{600.0f, 400.0f, 10.0f, 10.0f, kPersonClassId, 1.0f}};
  EXPECT_TRUE(backgroundSuffices(scene.pairs(), inverted, fixedOptions()));
  const MotionModelEstimate found = estimateMotionModel(scene.pairs(), inverted, fixedOptions());
  EXPECT_EQ(found.source, MatchSource::kBackground);
  EXPECT_EQ(found.matches, 200U);
}

TEST(MatchSource, ACrowdThatIsKnownToMoveIsNotTakenForTheWorld) {
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    const Crowd crowd(seed);
    // Without flags the many are the world ...
    const MotionModelEstimate fooled =
        estimateMotionModel(crowd.scene.pairs(), kWholeImage, fixedOptions());
    EXPECT_EQ(fooled.source, MatchSource::kAll);
    EXPECT_EQ(fooled.matches, 300U);
    EXPECT_LT(crowd.shareOnLines(fooled.model, false), 0.5) << "seed " << seed;

    // ... with them they are not.
    const MotionModelEstimate found =
        estimateMotionModel(crowd.scene.pairs(), kWholeImage, crowd.moving, fixedOptions());
    EXPECT_EQ(found.source, MatchSource::kNotMoving);
    EXPECT_EQ(found.matches, crowd.at_rest);
    EXPECT_EQ(found.verdict, FundamentalVerdict::kDefined);
    EXPECT_GT(crowd.shareOnLines(found.model, false), 0.95) << "seed " << seed;
    EXPECT_LT(crowd.shareOnLines(found.model, true), 0.1) << "seed " << seed;
  }
}

TEST(MatchSource, EnoughBackgroundNeedsNoFlags) {
  const Crowd crowd(1);
  const MotionModelEstimate with =
      estimateMotionModel(crowd.scene.pairs(), {}, crowd.moving, fixedOptions());
  const MotionModelEstimate without = estimateMotionModel(crowd.scene.pairs(), {}, fixedOptions());
  EXPECT_EQ(with.source, MatchSource::kBackground);
  EXPECT_EQ(with.model.matrix, without.model.matrix);
}

TEST(MatchSource, TooLittleAtRestGivesAllPoints) {
  const Crowd crowd(1);
  MotionModelOptions options = fixedOptions();
  // Too few: 100 of 300 are at rest.
  ASSERT_EQ(crowd.at_rest, 100U);
  options.min_background_matches = 101;
  EXPECT_EQ(estimateMotionModel(crowd.scene.pairs(), kWholeImage, crowd.moving, options).source,
            MatchSource::kAll);
  options.min_background_matches = 100;
  EXPECT_EQ(estimateMotionModel(crowd.scene.pairs(), kWholeImage, crowd.moving, options).source,
            MatchSource::kNotMoving);

  // In too few cells: only what lies in the upper left quarter is at rest, which is four cells.
  const TwoViewScene& scene = crowd.scene;
  std::vector<std::uint8_t> moving(scene.size(), 0);
  for (std::size_t i = 0; i < scene.size(); ++i) {
    moving[i] = scene.current_u[i] > 300.0f || scene.current_v[i] > 220.0f ? 1 : 0;
  }
  options.min_background_matches = 12;
  EXPECT_EQ(estimateMotionModel(scene.pairs(), kWholeImage, moving, options).source,
            MatchSource::kAll);
  options.min_background_cells = 4;
  EXPECT_EQ(estimateMotionModel(scene.pairs(), kWholeImage, moving, options).source,
            MatchSource::kNotMoving);
}

TEST(MatchSource, FlagsOfAnotherSizeAreRefused) {
  const TwoViewScene scene = sceneOf(20);
  const std::vector<std::uint8_t> flags(19, 0);
  EXPECT_EQ(test::invalidArgumentOf(
                [&] { estimateMotionModel(scene.pairs(), {}, flags, fixedOptions()); }),
            "moving has 19 flags; expected 0 or one for each of the 20 pairs");
}

}  // namespace
}  // namespace hmcdyn

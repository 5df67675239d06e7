// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <hmcdyn/steps/fundamental.hpp>

#include "invalid_argument.hpp"
#include "motion_model_settings.hpp"
#include "random.hpp"
#include "two_view_scene.hpp"

namespace hmcdyn {
namespace {

using test::fixedTwoViewOptions;
using test::makeScene;
using test::motionOf;
using test::noisy;
using test::SceneSettings;
using test::TwoViewScene;

TwoViewEstimate estimate(const TwoViewScene& scene, const std::vector<DetectionBox>& boxes = {},
                         const TwoViewOptions& options = fixedTwoViewOptions()) {
  return estimateTwoViewModel(scene.pairs(), boxes, options);
}

double quantile(std::vector<float> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

/// Motions with enough translation for F.
std::vector<Eigen::Isometry3d> translations() {
  return {motionOf({0.0, 0.0, 0.0}, {0.1, 0.0, 0.0}),
          motionOf({0.5, -1.0, 0.3}, {0.08, 0.05, 0.02}),
          motionOf({0.0, 2.0, 0.0}, {-0.15, 0.02, 0.05}),
          motionOf({0.3, 0.3, 1.0}, {0.03, 0.03, 0.25})};
}

class MotionModelSeeds : public ::testing::TestWithParam<std::uint32_t> {};

TEST_P(MotionModelSeeds, TranslationDefinesF) {
  for (const Eigen::Isometry3d& motion : translations()) {
    // Given a scene with depth, seen with the noise of tracked points
    const TwoViewEstimate found = estimate(makeScene(motion, noisy(GetParam())));

    // Then
    ASSERT_EQ(found.verdict, FundamentalVerdict::kDefined) << motion.matrix();
    EXPECT_TRUE(found.fundamentalDefined());
    EXPECT_EQ(found.model.kind, TwoViewModelKind::kFundamental);
    EXPECT_NEAR(found.model.matrix.map().determinant(), 0.0, 1e-12);
    EXPECT_EQ(found.matches, 300U);
    // Noise across the line has a deviation of test::kTrackedNoise * sqrt 2 (both frames), a median
    // of 0.143.
    EXPECT_NEAR(found.median_distance, 0.143, 0.04);
    EXPECT_GT(found.inliers, 270U);

    // And the model holds for points without noise: static ones are on their lines, those moved
    // across by 5 px are 5 px away.
    SceneSettings exact = noisy(GetParam() + 1000);
    exact.noise = 0.0;
    TwoViewScene scene = makeScene(motion, exact);
    const std::vector<float> at_rest = modelDistances(found.model, scene.pairs());
    EXPECT_LT(quantile(at_rest, 0.5), 0.1);
    EXPECT_LT(quantile(at_rest, 0.95), 0.3);
    for (std::size_t i = 0; i < scene.size(); ++i) {
      const Eigen::Vector2d along =
          test::epipolarDirection(test::kSceneCamera, motion, scene.earlier(i));
      scene.moveCurrent(i, 5.0 * Eigen::Vector2d(-along.y(), along.x()));
    }
    const std::vector<float> moved = modelDistances(found.model, scene.pairs());
    EXPECT_NEAR(quantile(moved, 0.05), 5.0, 0.35);
    EXPECT_NEAR(quantile(moved, 0.5), 5.0, 0.1);
    EXPECT_NEAR(quantile(moved, 0.95), 5.0, 0.35);
  }
}

TEST_P(MotionModelSeeds, AStillCameraMeasuresDisplacement) {
  // Given a camera that does not move, and a quarter of a scene that does, in a box.
  TwoViewScene scene = makeScene(motionOf({0, 0, 0}, {0, 0, 0}), noisy(GetParam()));
  const DetectionBox box{200.0f, 100.0f, 440.0f, 400.0f, kPersonClassId, 1.0f};
  for (std::size_t i = 0; i < scene.size(); ++i) {
    if (box.contains(scene.earlier_u[i], scene.earlier_v[i])) {
      scene.moveCurrent(i, {3.0, -4.0});
    }
  }
  TwoViewOptions options = fixedTwoViewOptions();
  options.still_displacement = 1.0f;  // noise of both frames, 5 deviations
  const TwoViewEstimate found = estimate(scene, {box}, options);
  EXPECT_EQ(found.verdict, FundamentalVerdict::kCameraStill);
  EXPECT_EQ(found.model.kind, TwoViewModelKind::kIdentity);
  EXPECT_FALSE(found.fundamentalDefined());
  EXPECT_EQ(found.source, MatchSource::kBackground);

  const std::vector<float> distance = modelDistances(found.model, scene.pairs());
  for (std::size_t i = 0; i < scene.size(); ++i) {
    const bool moved = box.contains(scene.earlier_u[i], scene.earlier_v[i]);
    EXPECT_NEAR(distance[i], moved ? 5.0 : 0.0, 1.0);
  }
}

/// A homography is the model of `scene`, and measures points of `exact`, the same without noise.
void expectHomography(const TwoViewScene& scene, TwoViewScene exact) {
  // Given a box, whose third of the points is left out
  const DetectionBox box{0.0f, 0.0f, 220.0f, 480.0f, kPersonClassId, 1.0f};
  const TwoViewEstimate found = estimate(scene, {box});
  ASSERT_EQ(found.verdict, FundamentalVerdict::kIllConditioned)
      << "conditioning " << found.conditioning;
  ASSERT_EQ(found.model.kind, TwoViewModelKind::kHomography);
  EXPECT_EQ(found.source, MatchSource::kBackground);
  EXPECT_LT(found.conditioning, 2.0f);
  // Noise of both frames in both directions: Rayleigh with deviation 0.212, median 0.25.
  EXPECT_NEAR(found.median_distance, 0.25, 0.06);

  // Then points that move across the homography are measured in every direction, in the box, too,
  // where the model is extrapolated.
  const std::vector<float> at_rest = modelDistances(found.model, exact.pairs());
  EXPECT_LT(quantile(at_rest, 0.95), 0.5);
  for (std::size_t i = 0; i < exact.size(); ++i) {
    const double angle = static_cast<double>(i);
    exact.moveCurrent(i, 4.0 * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  }
  const std::vector<float> moved = modelDistances(found.model, exact.pairs());
  EXPECT_NEAR(quantile(moved, 0.05), 4.0, 0.5);
  EXPECT_NEAR(quantile(moved, 0.95), 4.0, 0.5);
}

TEST_P(MotionModelSeeds, RotationLeavesFUndefined) {
  const Eigen::Isometry3d rotation = motionOf({1.0, -2.0, 0.5}, {0.0, 0.0, 0.0});
  SceneSettings exact = noisy(GetParam() + 1000);
  exact.noise = 0.0;
  expectHomography(makeScene(rotation, noisy(GetParam())), makeScene(rotation, exact));
}

TEST_P(MotionModelSeeds, APlaneLeavesFUndefined) {
  const Eigen::Isometry3d motion = motionOf({0.5, 1.0, 0.0}, {0.1, 0.05, 0.02});
  SceneSettings settings = noisy(GetParam());
  settings.planar = true;
  SceneSettings exact = settings;
  exact.seed += 1000;
  exact.noise = 0.0;
  expectHomography(makeScene(motion, settings), makeScene(motion, exact));
}

TEST_P(MotionModelSeeds, MoversInBoxesAreLeftOut) {
  // Given 40 % of the points in boxes, all moving together as one thing does
  const Eigen::Isometry3d motion = motionOf({0.2, -0.5, 0.1}, {0.1, 0.02, 0.03});
  TwoViewScene scene = makeScene(motion, noisy(GetParam(), 400));
  const DetectionBox box{0.0f, -20.0f, 256.0f, 500.0f, kPersonClassId, 1.0f};
  std::vector<bool> mover(scene.size());
  std::size_t movers = 0;
  for (std::size_t i = 0; i < scene.size(); ++i) {
    mover[i] = box.contains(scene.current_u[i], scene.current_v[i]);
    if (mover[i]) {
      ++movers;
      scene.earlier_v[i] += 8.0f;  // it rose by 8 px
    }
  }
  ASSERT_GT(movers, 120U);

  // When
  const TwoViewEstimate found = estimate(scene, {box});

  // Then
  ASSERT_EQ(found.verdict, FundamentalVerdict::kDefined);
  EXPECT_EQ(found.source, MatchSource::kBackground);
  EXPECT_EQ(found.matches, scene.size() - movers);
  const std::vector<float> distance = modelDistances(found.model, scene.pairs());
  std::vector<float> of_movers, of_background;
  for (std::size_t i = 0; i < scene.size(); ++i) {
    (mover[i] ? of_movers : of_background).push_back(distance[i]);
  }
  EXPECT_GT(quantile(of_movers, 0.05), 2.0);
  EXPECT_LT(quantile(of_background, 0.95), 0.7);
}

TEST_P(MotionModelSeeds, OutliersWithoutBoxesAreVotedDown) {
  const Eigen::Isometry3d motion = motionOf({0.2, -0.5, 0.1}, {0.1, 0.05, 0.03});
  TwoViewScene scene = makeScene(motion, noisy(GetParam()));
  test::Random random(GetParam());
  for (std::size_t i = 0; i < scene.size(); i += 4) {
    scene.moveCurrent(i, {random.uniform(-30.0, 30.0), random.uniform(-30.0, 30.0)});
  }
  const TwoViewEstimate found = estimate(scene);
  ASSERT_EQ(found.verdict, FundamentalVerdict::kDefined);
  SceneSettings exact = noisy(GetParam() + 1000);
  exact.noise = 0.0;
  EXPECT_LT(quantile(modelDistances(found.model, makeScene(motion, exact).pairs()), 0.95), 0.35);
}

TEST(MotionModel, RotationsHardlyEverPassForTranslations) {
  // Given 200 rotations and 200 sideways translations by 1 cm, which nobody can mistake:
  // 500 px * 0.01 m / 2 m is 2.5 px of parallax.
  int rotations_defined = 0;
  int translations_defined = 0;
  for (std::uint32_t seed = 1; seed <= 200; ++seed) {
    const TwoViewScene rotated = makeScene(motionOf({1.0, -2.0, 0.5}, {0, 0, 0}), noisy(seed));
    rotations_defined += estimate(rotated).fundamentalDefined() ? 1 : 0;
    const TwoViewScene moved = makeScene(motionOf({1.0, -2.0, 0.5}, {0.01, 0, 0}), noisy(seed));
    translations_defined += estimate(moved).fundamentalDefined() ? 1 : 0;
  }
  EXPECT_LE(rotations_defined, 2);
  EXPECT_GE(translations_defined, 198);
}

INSTANTIATE_TEST_SUITE_P(Seeds, MotionModelSeeds, ::testing::Range(1U, 9U));

TEST(MotionModel, TooFewMatchesGiveNone) {
  const Eigen::Isometry3d motion = motionOf({0.0, 0.0, 0.0}, {0.1, 0.0, 0.0});
  TwoViewOptions options = fixedTwoViewOptions();
  options.min_matches = 8;
  for (const std::size_t n : {0U, 1U, 7U}) {
    const TwoViewScene scene = makeScene(motion, noisy(1, n));
    const TwoViewEstimate found = estimate(scene, {}, options);
    EXPECT_EQ(found.verdict, FundamentalVerdict::kTooFewMatches) << n;
    EXPECT_EQ(found.model.kind, TwoViewModelKind::kNone);
    EXPECT_EQ(found.matches, n);
    EXPECT_EQ(found.inliers, 0U);
    EXPECT_TRUE(std::isnan(found.median_distance));
  }
  EXPECT_NE(estimate(makeScene(motion, noisy(1, 8)), {}, options).verdict,
            FundamentalVerdict::kTooFewMatches);
}

TEST(MotionModel, UnmatchedPointsAreLeftOut) {
  const Eigen::Isometry3d motion = motionOf({0.0, 0.0, 0.0}, {0.1, 0.05, 0.0});
  TwoViewScene scene = makeScene(motion, noisy(1));
  for (std::size_t i = 0; i < scene.size(); i += 2) {
    scene.earlier_u[i] = scene.earlier_v[i] =
        i % 4 == 0 ? kNaN : std::numeric_limits<float>::infinity();
  }
  const TwoViewEstimate found = estimate(scene);
  EXPECT_EQ(found.matches, 150U);
  EXPECT_EQ(found.verdict, FundamentalVerdict::kDefined);

  scene.earlier_u.assign(scene.size(), kNaN);
  const TwoViewEstimate none = estimate(scene);
  EXPECT_EQ(none.verdict, FundamentalVerdict::kTooFewMatches);
  EXPECT_EQ(none.matches, 0U);
}

TEST(MotionModel, DegenerateMatchesNeitherThrowNorDefineF) {
  const auto constellation = [](auto pixel_of) {
    TwoViewScene scene;
    for (int i = 0; i < 80; ++i) {
      const Eigen::Vector2f pixel = pixel_of(i);
      scene.earlier_u.push_back(pixel.x());
      scene.earlier_v.push_back(pixel.y());
      scene.current_u.push_back(pixel.x() + 3.0f);
      scene.current_v.push_back(pixel.y() + 1.0f);
    }
    return scene;
  };
  using Pixel = Eigen::Vector2f;
  // All at one place; all on a line; a few places, again and again; a grid, all moved alike.
  for (const TwoViewScene& scene :
       {constellation([](int) { return Pixel(100.0f, 100.0f); }),
        constellation([](int i) { return Pixel(5.0f * static_cast<float>(i), 50.0f); }),
        constellation([](int i) { return Pixel(static_cast<float>(i % 2) * 300.0f, 9.0f); }),
        constellation([](int i) {
          return Pixel(static_cast<float>(i % 10) * 60.0f, static_cast<float>(i / 10) * 60.0f);
        })}) {
    const TwoViewEstimate found = estimate(scene);
    EXPECT_NE(found.verdict, FundamentalVerdict::kDefined) << "conditioning " << found.conditioning;
    for (const float distance : modelDistances(found.model, scene.pairs())) {
      EXPECT_TRUE(std::isnan(distance) || distance < 0.5f) << distance;
    }
  }
}

TEST(MotionModel, HugePixelsDoNoHarm) {
  TwoViewScene scene = makeScene(motionOf({0.0, 0.0, 0.0}, {0.1, 0.05, 0.0}), noisy(1));
  scene.current_u[0] = 3e38f;
  scene.earlier_v[1] = -3e38f;
  const TwoViewEstimate found = estimate(scene);
  EXPECT_EQ(found.verdict, FundamentalVerdict::kDefined);
  EXPECT_NEAR(found.median_distance, 0.143, 0.04);
}

TEST(MotionModel, RepeatsBitForBitForASeed) {
  for (const Eigen::Isometry3d& motion : {motionOf({0.2, -0.5, 0.1}, {0.1, 0.02, 0.03}),
                                          motionOf({1.0, -2.0, 0.5}, {0.0, 0.0, 0.0})}) {
    TwoViewScene scene = makeScene(motion, noisy(3));
    test::Random random(9);
    for (std::size_t i = 0; i < scene.size(); i += 3) {
      scene.moveCurrent(i, {random.uniform(-9.0, 9.0), random.uniform(-9.0, 9.0)});
    }
    const TwoViewEstimate first = estimate(scene);
    // Whatever ran before, and in whatever state OpenCV's own generator is.
    cv::theRNG().state = 12345;
    estimate(makeScene(motion, noisy(17)));
    const TwoViewEstimate second = estimate(scene);
    EXPECT_EQ(first.verdict, second.verdict);
    EXPECT_EQ(first.model.kind, second.model.kind);
    EXPECT_EQ(first.model.matrix, second.model.matrix);
    EXPECT_EQ(first.inliers, second.inliers);
    EXPECT_EQ(first.median_distance, second.median_distance);
    EXPECT_EQ(first.conditioning, second.conditioning);
  }
}

TEST(MotionModel, UnequalSizesAreRefused) {
  TwoViewScene scene = makeScene(motionOf({0.0, 0.0, 0.0}, {0.1, 0.0, 0.0}), noisy(1, 20));
  scene.current_v.pop_back();
  EXPECT_EQ(test::invalidArgumentOf([&] { estimate(scene); }),
            "point pairs: earlier u, v and current u, v have 20, 20, 20 and 19 elements; expected "
            "equal sizes");
}

TEST(MotionModel, OptionsOutOfRangeAreNamed) {
  const auto message = [](auto change) {
    TwoViewOptions options = fixedTwoViewOptions();
    change(options);
    return test::invalidArgumentOf([&] { estimateTwoViewModel({}, {}, options); });
  };
  using Options = TwoViewOptions;
  EXPECT_EQ(message([](Options& o) { o.min_matches = 7; }),
            "TwoViewOptions::min_matches is 7.000000; expected a count >= 8");
  EXPECT_EQ(message([](Options& o) { o.inlier_threshold = 0.0f; }),
            "TwoViewOptions::inlier_threshold is 0.000000; expected a value > 0 (px)");
  EXPECT_EQ(message([](Options& o) { o.confidence = 1.0; }),
            "TwoViewOptions::confidence is 1.000000; expected a probability in (0, 1)");
  EXPECT_EQ(message([](Options& o) { o.max_iterations = 0; }),
            "TwoViewOptions::max_iterations is 0.000000; expected a count >= 1");
  EXPECT_EQ(message([](Options& o) { o.still_share = 0.0f; }),
            "TwoViewOptions::still_share is 0.000000; expected a share in (0, 1]");
  EXPECT_EQ(message([](Options& o) { o.still_displacement = kNaN; }),
            "TwoViewOptions::still_displacement is nan; expected a value >= 0 (px)");
  EXPECT_EQ(message([](Options& o) { o.min_conditioning = 0.5f; }),
            "TwoViewOptions::min_conditioning is 0.500000; expected a ratio >= 1");
  EXPECT_EQ(message([](Options& o) { o.min_homography_share = 1.5f; }),
            "TwoViewOptions::min_homography_share is 1.500000; expected a share in [0, 1]");
  EXPECT_EQ(message([](Options&) {}), "nothing thrown");
}

TEST(MotionModel, VerdictsHaveNames) {
  EXPECT_STREQ(toString(FundamentalVerdict::kDefined), "defined");
  EXPECT_STREQ(toString(FundamentalVerdict::kTooFewMatches), "too few matches");
  EXPECT_STREQ(toString(FundamentalVerdict::kCameraStill), "camera still");
  EXPECT_STREQ(toString(FundamentalVerdict::kIllConditioned), "ill-conditioned");
  EXPECT_STREQ(toString(FundamentalVerdict::kNoConsensus), "no consensus");
}

}  // namespace
}  // namespace hmcdyn

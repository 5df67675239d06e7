// SPDX-License-Identifier: BSD-3-Clause
// A predicted fundamental matrix in place of random draws.
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <hmcdyn/steps/fundamental.hpp>

#include "motion_model_settings.hpp"
#include "two_view_scene.hpp"

namespace hmcdyn {
namespace {

using test::fixedTwoViewOptions;
using test::motionOf;
using test::TwoViewScene;

Eigen::Isometry3d trueMotion() { return motionOf({0.2, -0.5, 0.1}, {0.1, 0.02, 0.03}); }

TwoViewModel modelFrom(const Eigen::Isometry3d& motion) {
  return {TwoViewModelKind::kFundamental, test::fundamentalOf(test::kSceneCamera, motion)};
}

TwoViewEstimate estimateFrom(const TwoViewScene& scene, const TwoViewModel& predicted,
                             std::uint32_t seed = 1) {
  TwoViewOptions options = fixedTwoViewOptions();
  options.seed = seed;
  return estimateTwoViewModel(scene.pairs(), {}, {}, options, predicted);
}

TwoViewEstimate drawnFrom(const TwoViewScene& scene) {
  return estimateTwoViewModel(scene.pairs(), {}, fixedTwoViewOptions());
}

/// `percent` of a hundred of the points rise by 8 px.
TwoViewScene sceneWithMovers(std::size_t percent, std::uint32_t seed) {
  TwoViewScene scene = test::makeScene(trueMotion(), test::noisy(seed));
  for (std::size_t i = 0; i < scene.size(); ++i) {
    if (i % 100 < percent) {
      scene.moveCurrent(i, {0.0, -8.0});
    }
  }
  return scene;
}

TEST(PredictedModel, ANearOneNeedsNoDraws) {
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    // Given a prediction that is wrong by 1 mrad and 3 mm of 107, and a fifth of the points moving
    const TwoViewScene scene = sceneWithMovers(20, seed);
    const TwoViewModel predicted =
        modelFrom(motionOf({0.0, 0.06, 0.0}, {0.0, 0.003, 0.0}) * trueMotion());

    // Then the seed of the draws does not matter
    const TwoViewEstimate found = estimateFrom(scene, predicted, 1);
    EXPECT_EQ(found.model.matrix, estimateFrom(scene, predicted, 2).model.matrix);

    // And the points at rest are where MAGSAC's model has them, to a fraction of their noise
    ASSERT_EQ(found.verdict, FundamentalVerdict::kDefined);
    const TwoViewEstimate drawn = drawnFrom(scene);
    const std::vector<float> distance = modelDistances(found.model, scene.pairs());
    const std::vector<float> expected = modelDistances(drawn.model, scene.pairs());
    for (std::size_t i = 0; i < scene.size(); ++i) {
      if (i % 100 >= 20) {
        EXPECT_NEAR(distance[i], expected[i], 0.3) << "seed " << seed << ", point " << i;
      }
    }
    EXPECT_NEAR(static_cast<double>(found.inliers), static_cast<double>(drawn.inliers), 10.0);
  }
}

TEST(PredictedModel, AWrongOneChangesNothing) {
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    const TwoViewScene scene = sceneWithMovers(20, seed);
    const TwoViewEstimate drawn = drawnFrom(scene);
    // across the true way, and one that no match agrees with
    const TwoViewModel across = modelFrom(motionOf({0.0, 0.0, 0.0}, {0.0, 0.1, 0.0}));
    EXPECT_EQ(estimateFrom(scene, across).model.matrix, drawn.model.matrix);
    const TwoViewModel nothing{TwoViewModelKind::kFundamental, Eigen::Matrix3d::Zero()};
    EXPECT_EQ(estimateFrom(scene, nothing).model.matrix, drawn.model.matrix);
    TwoViewModel broken = modelFrom(trueMotion());
    Eigen::Matrix3d not_finite = broken.matrix.map();
    not_finite(1, 1) = kNaN;
    broken.matrix = not_finite;
    EXPECT_EQ(estimateFrom(scene, broken).model.matrix, drawn.model.matrix);
  }
}

TEST(PredictedModel, WhereFewAgreeItIsDrawnAnew) {
  // Given more movers than leave a clear majority, and the true motion as the prediction
  const TwoViewScene scene = sceneWithMovers(40, 3);
  EXPECT_EQ(estimateFrom(scene, modelFrom(trueMotion())).model.matrix,
            drawnFrom(scene).model.matrix);
}

TEST(PredictedModel, OfAnotherKindIsNone) {
  const TwoViewScene scene = sceneWithMovers(20, 1);
  TwoViewModel homography = modelFrom(trueMotion());
  homography.kind = TwoViewModelKind::kHomography;
  EXPECT_EQ(estimateFrom(scene, homography).model.matrix, drawnFrom(scene).model.matrix);
}

}  // namespace
}  // namespace hmcdyn

// SPDX-License-Identifier: BSD-3-Clause
// Properties that show over many noisy frames: the covariance, and what a depth row is worth.
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <hmcdyn/pose_refinement.hpp>

#include "pose_scene.hpp"

namespace hmcdyn {
namespace {

using test::makePoseScene;
using test::motionBetween;
using test::observe;
using test::PoseScene;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

struct CovarianceCase {
  const char* name;
  DepthRow row;
  bool weighted;  ///< Weights of 1/4 on half of the points, with noise of sigma / weight.
};

class Covariance : public ::testing::TestWithParam<CovarianceCase> {};

TEST_P(Covariance, IsTheSpreadOfTheEstimates) {
  // Given one scene observed 600 times with Gaussian noise of the deviations stated,
  constexpr int kTrials = 600;
  PoseScene scene = makePoseScene(41, 48);
  for (std::size_t i = 0; i < scene.size(); i += 3) {
    scene.sigma[i] = 2.0f;
  }
  const std::vector<float> stated = scene.sigma;
  if (GetParam().weighted) {
    for (std::size_t i = 0; i < 24; ++i) {
      scene.weight[i] = 0.25f;
    }
  }
  PoseRefinementOptions options;
  options.depth_row = GetParam().row;
  options.loss = RobustLoss::kNone;
  options.rounds = 1;
  options.plain_rounds = 0;

  std::mt19937 random(42);
  Matrix6d spread = Matrix6d::Zero();
  Matrix6d claimed = Matrix6d::Zero();
  double normalised = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    for (std::size_t i = 0; i < scene.size(); ++i) {
      scene.sigma[i] = stated[i] / scene.weight[i];  // what lambda claims of the noise
    }
    observe(scene, random, 1.0);
    scene.sigma = stated;
    const auto result = refinePose(scene.view(), scene.camera, scene.camera_from_world, options);
    ASSERT_TRUE(result.covariance);
    const Vector6d delta = motionBetween(result.camera_from_world, scene.camera_from_world);
    spread += delta * delta.transpose() / kTrials;
    claimed += result.covariance->map() / kTrials;
    normalised += delta.dot(result.covariance->map().ldlt().solve(delta)) / kTrials;
  }

  // then the squared error in units of the covariance is chi2(6): mean 6, variance 12,
  EXPECT_NEAR(normalised, 6.0, 4.0 * std::sqrt(12.0 / kTrials));
  // and each variance is as claimed: a relative deviation of sqrt(2 / trials).
  for (int k = 0; k < 6; ++k) {
    EXPECT_NEAR(spread(k, k) / claimed(k, k), 1.0, 4.0 * std::sqrt(2.0 / kTrials)) << k;
  }
}

INSTANTIATE_TEST_SUITE_P(Rows, Covariance,
                         ::testing::Values(CovarianceCase{"pixels", DepthRow::kNone, false},
                                           CovarianceCase{"depth", DepthRow::kDepth, false},
                                           CovarianceCase{"weighted_pixels", DepthRow::kNone,
                                                          true}),
                         [](const auto& one) { return one.param.name; });

/// Depths as a stereo pair measures them: bf over a disparity whose right column has an error of
/// its own, of sigma as the left one.
void measureByStereo(PoseScene& scene, double baseline_fx, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0.0, 1.0);
  for (std::size_t i = 0; i < scene.size(); ++i) {
    const Eigen::Vector3d p =
        scene.camera_from_world * Eigen::Vector3d(scene.x[i], scene.y[i], scene.z[i]);
    const double right =
        scene.camera.project(p).x() - baseline_fx / p.z() + scene.sigma[i] * normal(random);
    scene.depth[i] = static_cast<float>(baseline_fx / (scene.u[i] - right));
  }
}

/// Root mean square of the error along the optical axis (m) over 60 frames of 40 points.
double axialError(DepthRow row, bool stereo) {
  constexpr unsigned kFrames = 60;
  double sum = 0.0;
  for (unsigned seed = 0; seed < kFrames; ++seed) {
    PoseScene scene = makePoseScene(1000 + seed, 40, 1.0);
    PoseRefinementOptions options;
    options.depth_row = row;
    options.depth_error.systematic_quadratic = 0.0f;  // as the scene
    if (stereo) {
      measureByStereo(scene, options.baseline_fx, seed);
    }
    const auto result = refinePose(scene.view(), scene.camera, scene.camera_from_world, options);
    EXPECT_TRUE(result.succeeded());
    const double error = motionBetween(result.camera_from_world, scene.camera_from_world)(5);
    sum += error * error / kFrames;
  }
  return std::sqrt(sum);
}

// 40 points of 1 px leave an axial error of about 2 mm; their depths, good to 2-40 mm each, know it
// better than that.
TEST(DepthRow, DepthTightensTheTranslationAlongTheOpticalAxis) {
  EXPECT_LT(axialError(DepthRow::kDepth, false), 0.8 * axialError(DepthRow::kNone, false));
}

TEST(DepthRow, DisparityTightensItForAStereoPair) {
  EXPECT_LT(axialError(DepthRow::kDisparity, true), 0.9 * axialError(DepthRow::kNone, true));
}

}  // namespace
}  // namespace hmcdyn

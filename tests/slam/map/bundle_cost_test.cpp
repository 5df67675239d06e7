// SPDX-License-Identifier: BSD-3-Clause
// The derivatives of a bundle adjustment's residual against central differences along
// se3::Manifold.
#include "slam/map/bundle_cost.hpp"

#include <array>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "map/bundle_scene.hpp"
#include "se3_manifold.hpp"

namespace hmcdyn::slam {
namespace {

constexpr double kStep = 1e-6;

Eigen::VectorXd valueOf(const BundleCost& cost, const se3::PoseVector& pose,
                        const PointVector& point) {
  const std::array<const double*, 2> parameters{pose.data(), point.data()};
  Eigen::VectorXd residuals(cost.num_residuals());
  EXPECT_TRUE(cost.Evaluate(parameters.data(), residuals.data(), nullptr));
  return residuals;
}

void expectDerivatives(const BundleObservation& observation, const Eigen::Vector3d& in_camera) {
  const BundleModel model{{535.4, 539.2, 320.1, 247.6}, 0.05};
  const BundleCost cost(measurementOf(observation, {}), model);
  const Eigen::Isometry3d isometry =
      test::moved(Eigen::Isometry3d::Identity(), {0.3, -0.5, 1.1}, {0.4, -0.2, 0.7});
  const se3::PoseVector pose = se3::toPoseVector(isometry);
  PointVector point;
  point << isometry.inverse() * in_camera, 0.012;  // depths 1.2 % too large at 1 m

  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  RowMajor by_pose(cost.num_residuals(), se3::kPoseSize);
  RowMajor by_point(cost.num_residuals(), kPointSize);
  const std::array<const double*, 2> parameters{pose.data(), point.data()};
  std::array<double*, 2> jacobians{by_pose.data(), by_point.data()};
  Eigen::VectorXd residuals(cost.num_residuals());
  ASSERT_TRUE(cost.Evaluate(parameters.data(), residuals.data(), jacobians.data()));

  for (int k = 0; k < 6; ++k) {
    std::array<Eigen::VectorXd, 2> values;
    for (const int side : {0, 1}) {
      Eigen::Matrix<double, 6, 1> delta = Eigen::Matrix<double, 6, 1>::Zero();
      delta(k) = side == 0 ? -kStep : kStep;
      se3::PoseVector stepped;
      ASSERT_TRUE(se3::Manifold().Plus(pose.data(), delta.data(), stepped.data()));
      values.at(static_cast<std::size_t>(side)) = valueOf(cost, stepped, point);
    }
    const Eigen::VectorXd numeric = (values[1] - values[0]) / (2.0 * kStep);
    EXPECT_LT((by_pose.col(k) - numeric).norm(), 1e-6 * (1.0 + numeric.norm())) << k;
  }
  EXPECT_EQ(by_pose.col(6).norm(), 0.0);
  for (int k = 0; k < kPointSize; ++k) {
    const PointVector step = kStep * PointVector::Unit(k);
    const Eigen::VectorXd numeric =
        (valueOf(cost, pose, point + step) - valueOf(cost, pose, point - step)) / (2.0 * kStep);
    EXPECT_LT((by_point.col(k) - numeric).norm(), 1e-6 * (1.0 + numeric.norm())) << k;
  }
}

TEST(BundleCost, DerivativesWithDepth) {
  BundleObservation observation;
  observation.u = 100.0f;
  observation.v = 300.0f;
  observation.sigma = 1.44f;
  observation.depth = 2.2f;
  expectDerivatives(observation, {0.4, -0.3, 2.0});
}

TEST(BundleCost, DerivativesWithoutDepth) { expectDerivatives({}, {0.4, -0.3, 2.0}); }

TEST(BundleCost, DerivativesBehindTheCamera) {
  BundleObservation observation;
  observation.depth = 1.0f;
  expectDerivatives(observation, {0.04, -0.03, -0.5});
}

TEST(BundleCost, ResidualByHand) {
  // 2 m deep, 0.2 m to the right: 100 px from the centre; seen at 103 with sigma 2: 1.5 sigma.
  // With an offset of 0.02 / m the depth 2 m is measured as 2.08 m, and seen is 2.1 m; sigma is
  // given.
  BundleObservation observation;
  observation.u = 423.0f;
  observation.v = 240.0f;
  observation.sigma = 2.0f;
  observation.depth = 2.1f;
  observation.depth_sigma = 0.01f;
  const BundleModel model{{1000.0, 1000.0, 320.0, 240.0}, 0.05};
  const Eigen::Vector3d e =
      bundleResidual(measurementOf(observation, {}), model, {0.2, 0.0, 2.0}, 0.02);
  EXPECT_NEAR(e.x(), 1.5, 1e-12);
  EXPECT_NEAR(e.y(), 0.0, 1e-12);
  EXPECT_NEAR(e.z(), 2.0, 1e-4);
}

TEST(BundleCost, ADepthWithoutASigmaOfItsOwnHasTheModels) {
  BundleObservation observation;
  observation.depth = 2.0f;
  BundleOptions options;
  options.depth_error = {0.001f, 0.002f, 0.0f, 0.01f, 0.3f};
  // Noise 0.001 + 0.002 * 4 m = 9 mm; 0.3 of the systematic 40 mm: 12 mm; together 15 mm.
  EXPECT_NEAR(measurementOf(observation, options).inverse_sigma.z(), 1.0 / 0.015, 1e-4);
}

TEST(DepthOffsetPrior, IsTheOffsetInStandardDeviations) {
  const DepthOffsetPrior prior(0.01);
  const PointVector point(1.0, 2.0, 3.0, -0.025);
  const double* parameters = point.data();
  double residual = 0.0;
  PointVector derivative;
  double* jacobian = derivative.data();
  ASSERT_TRUE(prior.Evaluate(&parameters, &residual, &jacobian));
  EXPECT_DOUBLE_EQ(residual, -2.5);
  EXPECT_EQ(derivative, PointVector(0.0, 0.0, 0.0, 100.0));
}

}  // namespace
}  // namespace hmcdyn::slam

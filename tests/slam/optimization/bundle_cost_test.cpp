// SPDX-License-Identifier: BSD-3-Clause
// The derivatives of a bundle adjustment's residual against central differences along Se3Manifold.
#include "slam/optimization/bundle_cost.hpp"

#include <array>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "bundle_scene.hpp"
#include "slam/optimization/se3_manifold.hpp"

namespace hmcdyn::slam {
namespace {

constexpr double kStep = 1e-6;

Eigen::VectorXd valueOf(const BundleCost& cost, const PoseVector& pose,
                        const Eigen::Vector3d& point) {
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
  const PoseVector pose = toPoseVector(isometry);
  const Eigen::Vector3d point = isometry.inverse() * in_camera;

  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  RowMajor by_pose(cost.num_residuals(), kPoseSize);
  RowMajor by_point(cost.num_residuals(), 3);
  const std::array<const double*, 2> parameters{pose.data(), point.data()};
  std::array<double*, 2> jacobians{by_pose.data(), by_point.data()};
  Eigen::VectorXd residuals(cost.num_residuals());
  ASSERT_TRUE(cost.Evaluate(parameters.data(), residuals.data(), jacobians.data()));

  for (int k = 0; k < 6; ++k) {
    std::array<Eigen::VectorXd, 2> values;
    for (const int side : {0, 1}) {
      Eigen::Matrix<double, 6, 1> delta = Eigen::Matrix<double, 6, 1>::Zero();
      delta(k) = side == 0 ? -kStep : kStep;
      PoseVector stepped;
      ASSERT_TRUE(Se3Manifold().Plus(pose.data(), delta.data(), stepped.data()));
      values.at(static_cast<std::size_t>(side)) = valueOf(cost, stepped, point);
    }
    const Eigen::VectorXd numeric = (values[1] - values[0]) / (2.0 * kStep);
    EXPECT_LT((by_pose.col(k) - numeric).norm(), 1e-6 * (1.0 + numeric.norm())) << k;
  }
  EXPECT_EQ(by_pose.col(6).norm(), 0.0);
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(k);
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
  // sigma_z(2.1) = 0.001 + 1.425e-3 * 4.41 m.
  BundleObservation observation;
  observation.u = 423.0f;
  observation.v = 240.0f;
  observation.sigma = 2.0f;
  observation.depth = 2.1f;
  const BundleModel model{{1000.0, 1000.0, 320.0, 240.0}, 0.05};
  const Eigen::Vector3d e = bundleResidual(measurementOf(observation, {}), model, {0.2, 0.0, 2.0});
  EXPECT_NEAR(e.x(), 1.5, 1e-12);
  EXPECT_NEAR(e.y(), 0.0, 1e-12);
  EXPECT_NEAR(e.z(), 0.1 / (0.001 + 1.425e-3 * 4.41), 1e-4);
}

TEST(Se3Manifold, MinusUndoesPlus) {
  const PoseVector pose =
      toPoseVector(test::moved(Eigen::Isometry3d::Identity(), {0.3, -0.5, 1.1}, {0.4, -0.2, 0.7}));
  for (const double size : {0.0, 1e-13, 1e-6, 0.1, 2.5}) {
    Eigen::Matrix<double, 6, 1> delta;
    delta << 0.6 * size, -0.64 * size, 0.48 * size, 0.1, -0.2, 0.3;
    PoseVector stepped;
    ASSERT_TRUE(Se3Manifold().Plus(pose.data(), delta.data(), stepped.data()));
    const Eigen::Isometry3d expected =
        test::moved(toIsometry(pose), delta.head<3>(), delta.tail<3>());
    EXPECT_LT(test::poseDistance(toIsometry(stepped), expected), 1e-7);
    const Eigen::Isometry3d motion = toIsometry(stepped) * toIsometry(pose).inverse();
    const Eigen::Vector3d omega = logarithm(Eigen::Quaterniond(motion.linear()));
    EXPECT_LT((omega - delta.head<3>()).norm(), 1e-12);
    EXPECT_LT((motion.translation() - delta.tail<3>()).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
// The geometry of eq. 9: hand-computed rows, derivatives against differences.
#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <hmcdyn/pose_refinement.hpp>

#include "pose/residual.hpp"
#include "pose/solver.hpp"
#include "pose_scene.hpp"
#include "se3.hpp"

namespace hmcdyn::detail {
namespace {

using se3::Vector6d;
using test::gaussian3;
using test::moved;

// fx 500, fy 400, centre (320, 240), bf 40; the point (1, -0.5, 2) in the camera's frame projects
// to (570, 140), depth 2, right column 570 - 40 / 2 = 550.
ProjectionModel handModel(DepthRow row) { return {{500.0, 400.0, 320.0, 240.0}, row, 40.0, 0.05}; }

TEST(PointResidual, PixelRowsAreObservedMinusProjectedInSigmas) {
  const PointMeasurement point{{1.0, -0.5, 2.0}, {573.0, 138.0, 0.0}, {0.5, 0.5, 0.0}, 2};
  const auto at_origin = pointResidual(point, handModel(DepthRow::kNone),
                                       Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero());
  ASSERT_TRUE(at_origin);
  EXPECT_TRUE(at_origin->residual.isApprox(Eigen::Vector3d(1.5, -1.0, 0.0), 1e-12));
  EXPECT_TRUE(at_origin->jacobian.row(2).isZero(0.0));
  // -dh/dp / sigma in the translation's columns: fx / z = 250, -fx x / z^2 = -125;
  // fy / z = 200, -fy y / z^2 = 50.
  EXPECT_TRUE(
      at_origin->jacobian.row(0).tail<3>().isApprox(Eigen::RowVector3d(-125.0, 0.0, 62.5), 1e-12));
  EXPECT_TRUE(
      at_origin->jacobian.row(1).tail<3>().isApprox(Eigen::RowVector3d(0.0, -100.0, -25.0), 1e-12));
}

TEST(PointResidual, DepthRowIsInMetresOverItsOwnSigma) {
  const PointMeasurement point{{1.0, -0.5, 2.0}, {570.0, 140.0, 2.1}, {1.0, 1.0, 20.0}, 3};
  const auto at_origin = pointResidual(point, handModel(DepthRow::kDepth),
                                       Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero());
  ASSERT_TRUE(at_origin);
  EXPECT_NEAR(at_origin->residual.z(), 2.0, 1e-12);
  EXPECT_TRUE(
      at_origin->jacobian.row(2).tail<3>().isApprox(Eigen::RowVector3d(0.0, 0.0, -20.0), 1e-12));
}

TEST(PointResidual, DisparityRowIsTheColumnInTheVirtualRightCamera) {
  const PointMeasurement point{{1.0, -0.5, 2.0}, {570.0, 140.0, 551.0}, {1.0, 1.0, 0.5}, 3};
  const auto at_origin = pointResidual(point, handModel(DepthRow::kDisparity),
                                       Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero());
  ASSERT_TRUE(at_origin);
  EXPECT_NEAR(at_origin->residual.z(), 0.5, 1e-12);
  // d(u - bf / z)/dz = -125 + 40 / 4 = -115
  EXPECT_TRUE(
      at_origin->jacobian.row(2).tail<3>().isApprox(Eigen::RowVector3d(-125.0, 0.0, 57.5), 1e-12));
}

TEST(PointResidual, NothingBehindTheCameraOrNearerThanTheLimit) {
  const ProjectionModel model = handModel(DepthRow::kNone);
  const auto at_depth = [&model](double z) {
    const PointMeasurement point{{0.0, 0.0, z}, {320.0, 240.0, 0.0}, {1.0, 1.0, 0.0}, 2};
    return pointResidual(point, model, Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero())
        .has_value();
  };
  EXPECT_TRUE(at_depth(0.05));
  EXPECT_FALSE(at_depth(0.049));
  EXPECT_FALSE(at_depth(0.0));
  EXPECT_FALSE(at_depth(-1.0));
}

class PointJacobian : public ::testing::TestWithParam<DepthRow> {};

// A random point in front of a random camera, with errors of a few sigmas.
struct JacobianCase {
  PointMeasurement point;
  Eigen::Isometry3d pose;
};

JacobianCase randomCase(std::mt19937& random, const ProjectionModel& model) {
  JacobianCase one;
  one.pose = moved(Eigen::Isometry3d::Identity(), gaussian3(random, 1.0), gaussian3(random, 2.0));
  const Eigen::Vector3d p = gaussian3(random, 0.5) + Eigen::Vector3d(0.0, 0.0, 3.0);
  one.point.world = one.pose.inverse() * p;
  one.point.observed << model.camera.project(p), 0.0;
  one.point.observed += gaussian3(random, 2.0);
  one.point.inverse_sigma << 0.7, 0.7, 0.0;
  if (model.depth_row != DepthRow::kNone) {
    one.point.rows = 3;
    one.point.inverse_sigma.z() = 0.9;
    one.point.observed.z() += model.depth_row == DepthRow::kDepth ? p.z() : one.point.observed.x();
  }
  return one;
}

TEST_P(PointJacobian, AgreesWithCentralDifferences) {
  const ProjectionModel model = handModel(GetParam());
  std::mt19937 random(3);
  for (int repetition = 0; repetition < 20; ++repetition) {
    const JacobianCase one = randomCase(random, model);
    const auto residualAt = [&](const Vector6d& delta) {
      const Eigen::Isometry3d pose = moved(one.pose, delta.head<3>(), delta.tail<3>());
      return pointResidual(one.point, model, pose.linear(), pose.translation())->residual;
    };
    const auto at_pose = pointResidual(one.point, model, one.pose.linear(), one.pose.translation());
    ASSERT_TRUE(at_pose);
    constexpr double kStep = 1e-5;
    for (int k = 0; k < 6; ++k) {
      const Vector6d step = kStep * Vector6d::Unit(k);
      const Eigen::Vector3d difference = (residualAt(step) - residualAt(-step)) / (2.0 * kStep);
      EXPECT_TRUE(at_pose->jacobian.col(k).isApprox(difference, 1e-6) ||
                  (at_pose->jacobian.col(k) - difference).norm() < 1e-5)
          << "column " << k << ": " << at_pose->jacobian.col(k).transpose() << " against "
          << difference.transpose();
    }
  }
}

TEST_P(PointJacobian, TheCostHasItInItsFirstSixColumns) {
  const ProjectionModel model = handModel(GetParam());
  std::mt19937 random(4);
  const JacobianCase one = randomCase(random, model);
  const auto expected = pointResidual(one.point, model, one.pose.linear(), one.pose.translation());
  const se3::PoseVector pose = se3::toPoseVector(one.pose);
  const std::array<const double*, 1> parameters{pose.data()};
  Eigen::VectorXd residuals(one.point.rows);
  Eigen::Matrix<double, Eigen::Dynamic, se3::kPoseSize, Eigen::RowMajor> by_pose(one.point.rows,
                                                                                 se3::kPoseSize);
  std::array<double*, 1> jacobians{by_pose.data()};
  ASSERT_TRUE(expected);
  ASSERT_TRUE(
      PointCost(one.point, model).Evaluate(parameters.data(), residuals.data(), jacobians.data()));
  EXPECT_TRUE(residuals.isApprox(expected->residual.head(one.point.rows), 1e-9));
  EXPECT_TRUE(by_pose.leftCols<6>().isApprox(expected->jacobian.topRows(one.point.rows), 1e-9));
  EXPECT_TRUE(by_pose.col(6).isZero(0.0));
}

// lambda^2 of the loss, in closed form: Huber below and above its threshold, and the switch, whose
// rho is the minimum over lambda of lambda^2 s + kappa (lambda - lambda0)^2 over lambda0^2.
TEST(MakeLoss, ScalesByTheSquaredWeightOutsideTheLoss) {
  PoseRefinementOptions options;
  options.huber_two_rows = 2.0;
  WeightedPoint point;
  point.weight = 0.5;
  std::array<double, 3> rho{};
  makeLoss(point, options, true)->Evaluate(3.0, rho.data());
  EXPECT_NEAR(rho[0], 0.25 * 3.0, 1e-15);
  makeLoss(point, options, true)->Evaluate(9.0, rho.data());
  EXPECT_NEAR(rho[0], 0.25 * (2.0 * 2.0 * 3.0 - 4.0), 1e-15);
  makeLoss(point, options, false)->Evaluate(9.0, rho.data());
  EXPECT_NEAR(rho[0], 0.25 * 9.0, 1e-15);
}

TEST(MakeLoss, SwitchIsTheMinimumOverTheWeight) {
  PoseRefinementOptions options;
  options.kappa = 3.0;
  WeightedPoint point;
  point.weight = 0.8;
  point.switchable = true;
  for (const double s : {0.0, 0.5, 3.0, 40.0}) {
    double lowest = 1e300;
    for (int k = 0; k <= 100000; ++k) {  // lambda over a grid on [0, 1]
      const double lambda = k * 1e-5;
      lowest = std::min(lowest, lambda * lambda * s + 3.0 * (lambda - 0.8) * (lambda - 0.8));
    }
    std::array<double, 3> rho{};
    makeLoss(point, options, true)->Evaluate(s, rho.data());
    EXPECT_NEAR(rho[0], lowest, 1e-8) << "s = " << s;

    constexpr double kStep = 1e-5;
    std::array<double, 3> above{};
    std::array<double, 3> below{};
    makeLoss(point, options, true)->Evaluate(s + kStep, above.data());
    makeLoss(point, options, true)->Evaluate(s - kStep, below.data());
    EXPECT_NEAR(rho[1], (above[0] - below[0]) / (2.0 * kStep), 1e-9);
    EXPECT_NEAR(rho[2], (above[1] - below[1]) / (2.0 * kStep), 1e-9);
  }
}

INSTANTIATE_TEST_SUITE_P(AllRows, PointJacobian,
                         ::testing::Values(DepthRow::kNone, DepthRow::kDepth,
                                           DepthRow::kDisparity));

}  // namespace
}  // namespace hmcdyn::detail

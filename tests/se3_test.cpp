// SPDX-License-Identifier: BSD-3-Clause
// Rigid motions against Eigen's angle and axis, each other and central differences.
#include "se3.hpp"

#include <cmath>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "pose_scene.hpp"
#include "se3_manifold.hpp"

namespace hmcdyn::se3 {
namespace {

// A rotation vector of that length; the axis is 0.6, -0.64, 0.48.
Eigen::Vector3d turn(double radians) { return radians * Eigen::Vector3d(0.6, -0.64, 0.48); }

Eigen::Isometry3d somewhere() {
  return test::moved(Eigen::Isometry3d::Identity(), {0.3, -0.5, 1.1}, {0.4, -0.2, 0.7});
}

TEST(Se3, SkewIsTheCrossProduct) {
  const Eigen::Vector3d a(1.0, -2.0, 3.0);
  const Eigen::Vector3d b(0.5, 0.25, -4.0);
  EXPECT_EQ(skew(a) * b, a.cross(b));
}

TEST(Se3, ExponentialIsAngleAndAxis) {
  for (const double angle : {1e-12, 1e-3, 0.199, 0.2, 0.201, 1.0, 3.0}) {  // the series ends at 0.2
    const Eigen::Vector3d omega = turn(angle);
    const Eigen::Quaterniond expected(Eigen::AngleAxisd(angle, omega / angle));
    EXPECT_LT((exponential(omega).coeffs() - expected.coeffs()).norm(), 1e-15) << angle;
  }
  EXPECT_EQ(exponential(Eigen::Vector3d::Zero()).coeffs(), Eigen::Quaterniond::Identity().coeffs());
}

TEST(Se3, LogarithmUndoesExponential) {
  for (const double angle : {0.0, 1e-13, 1e-6, 0.1, 2.5, 3.14}) {
    EXPECT_LT((logarithm(exponential(turn(angle))) - turn(angle)).norm(), 1e-13) << angle;
  }
  // The same rotation by the other quaternion, and one of more than half a turn the short way.
  const Eigen::Quaterniond other(-exponential(turn(1.0)).coeffs());
  EXPECT_LT((logarithm(other) - turn(1.0)).norm(), 1e-15);
  EXPECT_LT((logarithm(exponential(turn(4.0))) - turn(4.0 - 2.0 * M_PI)).norm(), 1e-14);
}

TEST(Se3, StepsAndMotionsAreOneToOne) {
  Vector6d delta;
  delta << turn(0.7), 0.1, -0.2, 0.3;
  const Eigen::Isometry3d motion = motionOf(delta);
  EXPECT_TRUE(motion.linear().isApprox(
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(0.6, -0.64, 0.48)).toRotationMatrix(), 1e-15));
  EXPECT_EQ(motion.translation(), Eigen::Vector3d(0.1, -0.2, 0.3));
  EXPECT_LT((stepOf(motion) - delta).norm(), 1e-15);
}

TEST(Se3, AStepIsAMotionInTheCamerasFrame) {
  for (const double size : {0.0, 1e-13, 1e-6, 0.1, 2.5}) {
    Vector6d delta;
    delta << turn(size), 0.1, -0.2, 0.3;
    const PoseVector from = toPoseVector(somewhere());
    const PoseVector to = moved(from, delta);
    const Eigen::Isometry3d expected = test::moved(somewhere(), delta.head<3>(), delta.tail<3>());
    EXPECT_TRUE(toIsometry(to).isApprox(expected, 1e-14)) << size;
    EXPECT_LT((between(from, to) - delta).norm(), 1e-14) << size;
  }
}

TEST(Se3, TheAdjointCarriesAStepOver) {
  // motion * step = carried step * motion, to first order: by central differences.
  const Eigen::Isometry3d motion = somewhere();
  constexpr double kStep = 1e-6;
  for (int k = 0; k < 6; ++k) {
    const auto carried = [&](double size) {
      return stepOf(motion * motionOf(size * Vector6d::Unit(k)) * motion.inverse());
    };
    const Vector6d numeric = (carried(kStep) - carried(-kStep)) / (2.0 * kStep);
    EXPECT_LT((adjoint(motion).col(k) - numeric).norm(), 1e-9) << k;
  }
}

TEST(Se3Manifold, MovesAsTheStepsDo) {
  const PoseVector pose = toPoseVector(somewhere());
  Vector6d delta;
  delta << turn(0.3), 0.4, -0.5, 0.6;
  PoseVector stepped;
  ASSERT_TRUE(Manifold().Plus(pose.data(), delta.data(), stepped.data()));
  EXPECT_EQ(stepped, moved(pose, delta));
#ifdef HMCDYN_CERES_HAS_MANIFOLD
  Vector6d back;
  ASSERT_TRUE(Manifold().Minus(stepped.data(), pose.data(), back.data()));
  EXPECT_LT((back - delta).norm(), 1e-15);
  Eigen::Matrix<double, kPoseSize, 6, Eigen::RowMajor> plus;
  Eigen::Matrix<double, 6, kPoseSize, Eigen::RowMajor> minus;
  ASSERT_TRUE(Manifold().PlusJacobian(pose.data(), plus.data()));
  ASSERT_TRUE(Manifold().MinusJacobian(pose.data(), minus.data()));
  EXPECT_TRUE((minus * plus).isIdentity(0.0));
#endif
}

}  // namespace
}  // namespace hmcdyn::se3

// SPDX-License-Identifier: BSD-3-Clause
#include "slam/map/relative_pose_cost.hpp"

#include <cmath>
#include <string>

#include <Eigen/Eigenvalues>

#include "se3.hpp"
#include "slam/map/optimization_input.hpp"

namespace hmcdyn::slam {
namespace {

using se3::Matrix6d;
using se3::Vector6d;

/// d Log(Exp(omega) R) / d omega at omega = 0, for Log(R) = phi: the inverse of SO(3)'s left
/// Jacobian (Sola, Deray and Atchuthan, A micro Lie theory, 2018).
Eigen::Matrix3d inverseLeftJacobian(const Eigen::Vector3d& phi) {
  const double angle = phi.norm();
  const Eigen::Matrix3d cross = se3::skew(phi);
  // 1 / a^2 - cot(a / 2) / (2 a), by its limit where the difference would lose digits.
  const double factor = angle < 1e-4
                            ? 1.0 / 12.0
                            : 1.0 / (angle * angle) - 1.0 / (2.0 * angle * std::tan(0.5 * angle));
  return Eigen::Matrix3d::Identity() - 0.5 * cross + factor * cross * cross;
}

}  // namespace

Matrix6d squareRootOf(const Matrix6d& information, const std::string& argument) {
  require(information.allFinite(), argument, "not finite", "a finite matrix");
  const double size = information.norm();
  constexpr double kRounding = 1e-9;
  require((information - information.transpose()).norm() <= kRounding * size, argument,
          "not symmetric", "a symmetric matrix");
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(information);
  require(eigen.eigenvalues()(0) >= -kRounding * size, argument,
          "of the eigenvalue " + std::to_string(eigen.eigenvalues()(0)),
          "a positive semidefinite matrix");
  return eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() *
         eigen.eigenvectors().transpose();
}

// NOLINTNEXTLINE(modernize-pass-by-value): Eigen types are not passed by value
RelativePoseCost::RelativePoseCost(const Eigen::Isometry3d& to_from, const Matrix6d& square_root)
    : from_to_(to_from.inverse()), square_root_(square_root) {
  set_num_residuals(6);
  *mutable_parameter_block_sizes() = {se3::kPoseSize, se3::kPoseSize};
}

bool RelativePoseCost::Evaluate(double const* const* parameters, double* residuals,
                                double** jacobians) const {
  const Eigen::Isometry3d from = se3::toIsometry(Eigen::Map<const se3::PoseVector>(parameters[0]));
  const Eigen::Isometry3d to = se3::toIsometry(Eigen::Map<const se3::PoseVector>(parameters[1]));
  const Eigen::Isometry3d between = to * from.inverse();
  const Eigen::Isometry3d error = between * from_to_;
  const Vector6d d = se3::stepOf(error);
  Eigen::Map<Vector6d>{residuals} = square_root_ * d;
  if (jacobians == nullptr) {
    return true;
  }
  Matrix6d by_to = Matrix6d::Zero();
  by_to.topLeftCorner<3, 3>() = inverseLeftJacobian(d.head<3>());
  by_to.bottomLeftCorner<3, 3>() = -se3::skew(error.translation());
  by_to.bottomRightCorner<3, 3>().setIdentity();
  by_to = square_root_ * by_to.eval();
  using RowMajorJacobian = Eigen::Matrix<double, 6, se3::kPoseSize, Eigen::RowMajor>;
  if (jacobians[0] != nullptr) {
    // A motion of `from` is its opposite of `to`, told in that frame.
    Matrix6d carried = Matrix6d::Zero();
    carried.topLeftCorner<3, 3>() = -between.linear();
    carried.bottomLeftCorner<3, 3>() = -se3::skew(between.translation()) * between.linear();
    carried.bottomRightCorner<3, 3>() = -between.linear();
    Eigen::Map<RowMajorJacobian>{jacobians[0]} << by_to * carried, Vector6d::Zero();
  }
  if (jacobians[1] != nullptr) {
    Eigen::Map<RowMajorJacobian>{jacobians[1]} << by_to, Vector6d::Zero();
  }
  return true;
}

}  // namespace hmcdyn::slam

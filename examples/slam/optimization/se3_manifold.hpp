// SPDX-License-Identifier: BSD-3-Clause
// Poses as Ceres holds and moves them, shared by the optimisations of this folder.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <ceres/version.h>

// Manifold came with Ceres 2.1, LocalParameterization left with 2.2.
#if CERES_VERSION_MAJOR > 2 || (CERES_VERSION_MAJOR == 2 && CERES_VERSION_MINOR >= 1)
// NOLINTNEXTLINE(cppcoreguidelines-macro-usage): the preprocessor asks for it
#define HMCDYN_SLAM_CERES_HAS_MANIFOLD 1
#include <ceres/manifold.h>
#else
// NOLINTNEXTLINE(cppcoreguidelines-macro-usage)
#define HMCDYN_SLAM_CERES_HAS_MANIFOLD 0
#include <ceres/local_parameterization.h>
#endif

namespace hmcdyn::slam {

/// A pose as (qx, qy, qz, qw, tx, ty, tz).
inline constexpr int kPoseSize = 7;
using PoseVector = Eigen::Matrix<double, kPoseSize, 1>;

PoseVector toPoseVector(const Eigen::Isometry3d& pose);
Eigen::Isometry3d toIsometry(const PoseVector& pose);

/// The matrix of the cross product: skew(a) b = a x b.
Eigen::Matrix3d skew(const Eigen::Vector3d& a);

/// Unit quaternion of a rotation vector (rad).
Eigen::Quaterniond exponential(const Eigen::Vector3d& omega);

/// Rotation vector (rad, length 0..pi) of a unit quaternion.
Eigen::Vector3d logarithm(const Eigen::Quaterniond& rotation);

/// What a small motion (rotation vector, translation) before a rigid one is after it:
/// motion * (Exp(omega), v) * motion^-1.
Eigen::Matrix<double, 6, 6> adjoint(const Eigen::Isometry3d& motion);

#if HMCDYN_SLAM_CERES_HAS_MANIFOLD
using Se3ManifoldBase = ceres::Manifold;
#else
using Se3ManifoldBase = ceres::LocalParameterization;
#endif

/// The steps of a pose: delta = (omega, v) moves (R, t) to (Exp(omega) R, Exp(omega) t + v), as in
/// hmcdyn::refinePose().
///
/// Ceres multiplies a cost's derivative by the seven numbers with PlusJacobian(). Here that is
/// (I6; 0), and the costs of this folder write their derivative by delta in the first six columns:
/// the same product without the detour over the quaternion, but no manifold for other costs.
class Se3Manifold final : public Se3ManifoldBase {
 public:
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
#if HMCDYN_SLAM_CERES_HAS_MANIFOLD
  int AmbientSize() const override { return kPoseSize; }
  int TangentSize() const override { return 6; }
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y, const double* x, double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;
#else
  int GlobalSize() const override { return kPoseSize; }
  int LocalSize() const override { return 6; }
  bool ComputeJacobian(const double* x, double* jacobian) const override;
#endif
};

}  // namespace hmcdyn::slam

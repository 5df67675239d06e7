// SPDX-License-Identifier: BSD-3-Clause
// Rigid motions: their steps and what belongs to them, for the library and the SLAM example. A step
// is delta = (omega, v), a rotation vector (rad) and a translation (m); it moves a pose (R, t) to
// (Exp(omega) R, Exp(omega) t + v), a motion in the camera's frame. The world's frame does not
// enter, so that the same problem told in another world frame takes the same steps.
#pragma once

#include <cmath>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace hmcdyn::se3 {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// A pose as the optimisers hold it: (qx, qy, qz, qw, tx, ty, tz).
inline constexpr int kPoseSize = 7;
using PoseVector = Eigen::Matrix<double, kPoseSize, 1>;

/// The two parts of a pose of seven numbers. Templates, as the library's Eigen has a name of its
/// own and the SLAM's has not: what returns it must not be one function for the linker.
template <class Scalar>
Eigen::Map<const Eigen::Quaternion<Scalar>> rotationOf(const Scalar* pose) {
  return Eigen::Map<const Eigen::Quaternion<Scalar>>(pose);
}
template <class Scalar>
Eigen::Map<const Eigen::Matrix<Scalar, 3, 1>> translationOf(const Scalar* pose) {
  return Eigen::Map<const Eigen::Matrix<Scalar, 3, 1>>(pose + 4);
}

inline PoseVector toPoseVector(const Eigen::Isometry3d& pose) {
  PoseVector vector;
  vector << Eigen::Quaterniond(pose.linear()).normalized().coeffs(), pose.translation();
  return vector;
}

inline Eigen::Isometry3d toIsometry(const PoseVector& pose) {
  Eigen::Isometry3d isometry = Eigen::Isometry3d::Identity();
  isometry.linear() = rotationOf(pose.data()).normalized().toRotationMatrix();
  isometry.translation() = translationOf(pose.data());
  return isometry;
}

/// The matrix of the cross product: skew(a) b = a x b.
inline Eigen::Matrix3d skew(const Eigen::Vector3d& a) {
  Eigen::Matrix3d m;
  m << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return m;
}

/// Unit quaternion of a rotation vector (rad).
inline Eigen::Quaterniond exponential(const Eigen::Vector3d& omega) {
  const double s = 0.25 * omega.squaredNorm();  // of half the angle
  double cosine = 0.0;
  double quotient = 0.0;  // sin(half) / half
  if (s < 0.01) {
    // Nearly every step: the series, whose next term is below 3e-17.
    cosine = 1.0 - s / 2.0 * (1.0 - s / 12.0 * (1.0 - s / 30.0 * (1.0 - s / 56.0)));
    quotient = 1.0 - s / 6.0 * (1.0 - s / 20.0 * (1.0 - s / 42.0 * (1.0 - s / 72.0)));
  } else {
    const double half = std::sqrt(s);
    cosine = std::cos(half);
    quotient = std::sin(half) / half;
  }
  Eigen::Quaterniond q;
  q.w() = cosine;
  q.vec() = 0.5 * quotient * omega;
  return q;
}

/// Rotation vector (rad, length 0..pi) of a unit quaternion.
inline Eigen::Vector3d logarithm(const Eigen::Quaterniond& rotation) {
  const double sine = rotation.vec().norm();  // of half the angle
  if (sine < 1e-10) {
    return rotation.w() < 0.0 ? -2.0 * rotation.vec() : 2.0 * rotation.vec();
  }
  const double half = rotation.w() < 0.0 ? std::atan2(-sine, -rotation.w())  // -q is the same
                                         : std::atan2(sine, rotation.w());
  return 2.0 * half / sine * rotation.vec();
}

/// The motion (Exp(omega), v) that a step makes of the identity.
inline Eigen::Isometry3d motionOf(const Vector6d& delta) {
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.linear() = exponential(delta.head<3>()).toRotationMatrix();
  motion.translation() = delta.tail<3>();
  return motion;
}

/// The step that makes a motion of the identity: motionOf() undone.
inline Vector6d stepOf(const Eigen::Isometry3d& motion) {
  Vector6d delta;
  delta << logarithm(Eigen::Quaterniond(motion.linear()).normalized()), motion.translation();
  return delta;
}

/// A pose after a step.
inline PoseVector moved(const PoseVector& pose, const Vector6d& delta) {
  const Eigen::Quaterniond step = exponential(delta.head<3>());
  PoseVector result;
  result.head<4>() = (step * rotationOf(pose.data())).normalized().coeffs();
  result.tail<3>() = step * translationOf(pose.data()) + delta.tail<3>();
  return result;
}

/// The step from one pose to another: between(pose, moved(pose, delta)) = delta.
inline Vector6d between(const PoseVector& from, const PoseVector& to) {
  const Eigen::Quaterniond step = rotationOf(to.data()) * rotationOf(from.data()).conjugate();
  Vector6d delta;
  delta << logarithm(step), translationOf(to.data()) - step * translationOf(from.data());
  return delta;
}

/// What a step before a rigid motion is after it: motion * (Exp(omega), v) * motion^-1, to first
/// order.
inline Matrix6d adjoint(const Eigen::Isometry3d& motion) {
  Matrix6d result = Matrix6d::Zero();
  result.topLeftCorner<3, 3>() = motion.linear();
  result.bottomRightCorner<3, 3>() = motion.linear();
  result.bottomLeftCorner<3, 3>() = skew(motion.translation()) * motion.linear();
  return result;
}

}  // namespace hmcdyn::se3

// SPDX-License-Identifier: BSD-3-Clause
#include "slam/optimization/se3_manifold.hpp"

#include <cmath>

namespace hmcdyn::slam {
namespace {

using Lift = Eigen::Matrix<double, kPoseSize, 6, Eigen::RowMajor>;

Eigen::Map<const Eigen::Quaterniond> rotationOf(const double* pose) {
  return Eigen::Map<const Eigen::Quaterniond>(pose);
}

Eigen::Map<const Eigen::Vector3d> translationOf(const double* pose) {
  return Eigen::Map<const Eigen::Vector3d>(pose + 4);
}

}  // namespace

PoseVector toPoseVector(const Eigen::Isometry3d& pose) {
  PoseVector vector;
  vector << Eigen::Quaterniond(pose.linear()).normalized().coeffs(), pose.translation();
  return vector;
}

Eigen::Isometry3d toIsometry(const PoseVector& pose) {
  Eigen::Isometry3d isometry = Eigen::Isometry3d::Identity();
  isometry.linear() = rotationOf(pose.data()).normalized().toRotationMatrix();
  isometry.translation() = translationOf(pose.data());
  return isometry;
}

Eigen::Matrix3d skew(const Eigen::Vector3d& a) {
  Eigen::Matrix3d m;
  m << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return m;
}

Eigen::Quaterniond exponential(const Eigen::Vector3d& omega) {
  const double half = 0.5 * omega.norm();
  // sin(half) / (2 half), by its series where the quotient would lose digits.
  const double factor = half > 1e-4 ? 0.5 * std::sin(half) / half : 0.5 - half * half / 12.0;
  Eigen::Quaterniond q;
  q.w() = std::cos(half);
  q.vec() = factor * omega;
  return q;
}

Eigen::Vector3d logarithm(const Eigen::Quaterniond& rotation) {
  const double sine = rotation.vec().norm();  // of half the angle
  if (sine < 1e-10) {
    return rotation.w() < 0.0 ? -2.0 * rotation.vec() : 2.0 * rotation.vec();
  }
  const double half = rotation.w() < 0.0 ? std::atan2(-sine, -rotation.w())  // -q is the same
                                         : std::atan2(sine, rotation.w());
  return 2.0 * half / sine * rotation.vec();
}

Eigen::Matrix<double, 6, 6> adjoint(const Eigen::Isometry3d& motion) {
  Eigen::Matrix<double, 6, 6> result = Eigen::Matrix<double, 6, 6>::Zero();
  result.topLeftCorner<3, 3>() = motion.linear();
  result.bottomRightCorner<3, 3>() = motion.linear();
  result.bottomLeftCorner<3, 3>() = skew(motion.translation()) * motion.linear();
  return result;
}

bool Se3Manifold::Plus(const double* x, const double* delta, double* x_plus_delta) const {
  const Eigen::Quaterniond step = exponential(Eigen::Map<const Eigen::Vector3d>(delta));
  const Eigen::Vector3d translation =
      step * translationOf(x) + Eigen::Map<const Eigen::Vector3d>(delta + 3);
  const Eigen::Quaterniond rotation = (step * rotationOf(x)).normalized();
  Eigen::Map<PoseVector>(x_plus_delta) << rotation.coeffs(), translation;
  return true;
}

#if HMCDYN_SLAM_CERES_HAS_MANIFOLD
bool Se3Manifold::PlusJacobian(const double* /*x*/, double* jacobian) const {
  Eigen::Map<Lift>{jacobian}.setIdentity();
  return true;
}

bool Se3Manifold::Minus(const double* y, const double* x, double* y_minus_x) const {
  const Eigen::Quaterniond step = rotationOf(y) * rotationOf(x).conjugate();
  Eigen::Map<Eigen::Matrix<double, 6, 1>>(y_minus_x) << logarithm(step),
      translationOf(y) - step * translationOf(x);
  return true;
}

bool Se3Manifold::MinusJacobian(const double* /*x*/, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, 6, kPoseSize, Eigen::RowMajor>>{jacobian}.setIdentity();
  return true;
}
#else
bool Se3Manifold::ComputeJacobian(const double* /*x*/, double* jacobian) const {
  Eigen::Map<Lift>{jacobian}.setIdentity();
  return true;
}
#endif

}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
// A rigid motion as the library and its user exchange it.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <hmcdyn/detail/requirements.hpp>
#include <hmcdyn/plain_matrix.hpp>

namespace hmcdyn {

/// A rigid motion, [R | t] row by row: 12 doubles wherever it is compiled, unlike Eigen::Isometry3d
/// (see PlainMatrix). Converts from and to it by itself; to compute, take Eigen's.
struct Pose {
  /// [R | t]: a rotation, and a translation (m). Identity at first.
  PlainMatrix<3, 4> matrix = Eigen::Matrix<double, 3, 4>::Identity();

  Pose() = default;  ///< Identity.
  /// From Eigen's.
  // NOLINTNEXTLINE(google-explicit-constructor,hicpp-explicit-conversions): stands for the other
  Pose(const Eigen::Isometry3d& motion) : matrix(motion.matrix().topRows<3>()) {}
  /// To Eigen's.
  // NOLINTNEXTLINE(google-explicit-constructor,hicpp-explicit-conversions): stands for the other
  operator Eigen::Isometry3d() const {
    Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
    motion.matrix().topRows<3>() = matrix.map();
    return motion;
  }

  /// R, read where it is.
  auto linear() const { return matrix.map().leftCols<3>(); }
  /// t (m), read where it is.
  auto translation() const { return matrix.map().col(3); }

  /// The point (m) where the motion takes it.
  friend Eigen::Vector3d operator*(const Pose& pose, const Eigen::Vector3d& point) {
    return Eigen::Isometry3d(pose) * point;
  }
  /// The motion `first`, and then `pose`.
  friend Eigen::Isometry3d operator*(const Pose& pose, const Eigen::Isometry3d& first) {
    return Eigen::Isometry3d(pose) * first;
  }
  /// Element by element, without a tolerance.
  friend bool operator==(const Pose& a, const Pose& b) { return a.matrix == b.matrix; }
  /// The opposite.
  friend bool operator!=(const Pose& a, const Pose& b) { return !(a == b); }
};

}  // namespace hmcdyn

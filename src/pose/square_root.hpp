// SPDX-License-Identifier: BSD-3-Clause
// A collapsed linearisation as a least squares problem of seven residuals.
#pragma once

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "pose/cholesky6.hpp"
#include "pose/kernel.hpp"

namespace hmcdyn::detail {

using SquareRootJacobian = Eigen::Ref<Eigen::Matrix<double, 7, 6>, 0, Eigen::OuterStride<7>>;

constexpr double kSmallestPivot = 1e-10;  // of a unit diagonal: less is rounding

/// The six rows of a system that leaves directions undetermined. Rarely called, and better not part
/// of the loop that calls it.
[[gnu::noinline]] inline Eigen::Matrix<double, 6, 1> squareRootOfSingular(
    const CollapsedSystem& system, SquareRootJacobian jacobian) {
  using Vector6d = Eigen::Matrix<double, 6, 1>;
  using Matrix6d = Eigen::Matrix<double, 6, 6>;
  const Vector6d diagonal = system.normal.diagonal();
  const Vector6d scale =
      diagonal.unaryExpr([](double d) { return d > 0.0 ? 1.0 / std::sqrt(d) : 0.0; });
  const Matrix6d scaled = scale.asDiagonal() * system.normal * scale.asDiagonal();
  const Eigen::LDLT<Matrix6d> pivoted(scaled);
  const Vector6d pivots = pivoted.vectorD();
  const Matrix6d permutation = pivoted.transpositionsP() * Matrix6d::Identity();
  const Matrix6d upper = pivoted.matrixU() * permutation;
  Vector6d y = pivoted.transpositionsP() * scale.cwiseProduct(system.gradient);
  pivoted.matrixL().solveInPlace(y);
  for (int k = 0; k < 6; ++k) {
    const double size = pivots(k) > kSmallestPivot ? std::sqrt(pivots(k)) : 0.0;
    y(k) = size > 0.0 ? y(k) / size : 0.0;
    jacobian.row(k) =
        size * upper.row(k).cwiseProduct(diagonal.transpose().cwiseMax(0.0).cwiseSqrt());
  }
  return y;
}

/// A collapsed system as seven residuals r, returned, and their Jacobian J, with J^T J = H,
/// J^T r = g and |r|^2 = cost: to a Gauss-Newton solver the same problem as the many residuals that
/// were collapsed into H and g.
///
/// The six rows are an upper triangular U with U^T U = H and y with U^T y = g; the seventh is
/// what of the cost no step can change, sqrt(cost - |y|^2), with a Jacobian of zero.
/// Where the points leave directions undetermined, H is singular: these get rows of zeros.
inline Eigen::Matrix<double, 7, 1> squareRootOf(const CollapsedSystem& system,
                                                SquareRootJacobian jacobian) {
  Eigen::Matrix<double, 7, 1> residuals;
  jacobian.setZero();
  Cholesky6 cholesky;
  cholesky.compute(system.normal);
  residuals.head<6>() = cholesky.pivotsExceed(kSmallestPivot)
                            ? cholesky.squareRoot(system.gradient, jacobian)
                            : squareRootOfSingular(system, jacobian);
  residuals(6) = std::sqrt(std::max(0.0, system.cost - residuals.head<6>().squaredNorm()));
  return residuals;
}

}  // namespace hmcdyn::detail

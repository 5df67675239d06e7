// SPDX-License-Identifier: BSD-3-Clause
// Cholesky's factorisation of a 6x6 matrix with all loops unrolled. Eigen's is written for any size
// and takes several times as long here, which shows: a pose of 50 points factorises ten times.
#pragma once

#include <Eigen/Core>

namespace hmcdyn::detail {

/// H = L D L^T, L with a unit diagonal. Has the interface that ceres::TinySolver expects of a
/// linear solver.
class Cholesky6 {
 public:
  using Matrix6d = Eigen::Matrix<double, 6, 6>;
  using Vector6d = Eigen::Matrix<double, 6, 1>;

  /// Reads the lower triangle. A matrix that is not positive definite has no pivotsExceed(0),
  /// and solutions that mean nothing.
  void compute(const Matrix6d& h) {
    diagonal_ = h.diagonal();
    Matrix6d scaled;  // L D
#pragma GCC unroll 6
    for (int j = 0; j < 6; ++j) {
      double pivot = h(j, j);
#pragma GCC unroll 6
      for (int k = 0; k < j; ++k) {
        pivot -= scaled(j, k) * lower_(j, k);
      }
      pivots_[j] = pivot;
      inverse_pivots_[j] = 1.0 / pivot;
#pragma GCC unroll 6
      for (int i = j + 1; i < 6; ++i) {
        double sum = h(i, j);
#pragma GCC unroll 6
        for (int k = 0; k < j; ++k) {
          sum -= scaled(i, k) * lower_(j, k);
        }
        scaled(i, j) = sum;
        lower_(i, j) = sum * inverse_pivots_[j];
      }
    }
  }

  /// Whether the columns before leave of each diagonal entry of H more than that share: 1 is left
  /// of a diagonal matrix, 0 of a singular one, whatever the units of its rows.
  bool pivotsExceed(double share) const {
    return ((pivots_ - share * diagonal_).array() > 0.0).all() && pivots_.allFinite();
  }

  /// Writes the upper triangle of U = D^1/2 L^T, for which U^T U = H, and returns y = U^-T b.
  template <class Upper>
  Vector6d squareRoot(const Vector6d& b, Upper&& upper) const {
    const Vector6d roots = pivots_.cwiseSqrt();
#pragma GCC unroll 6
    for (int i = 0; i < 6; ++i) {
      upper(i, i) = roots[i];
#pragma GCC unroll 6
      for (int j = i + 1; j < 6; ++j) {
        upper(i, j) = roots[i] * lower_(j, i);
      }
    }
    return solveLower(b).cwiseProduct(inverse_pivots_).cwiseProduct(roots);
  }

  /// H^-1 b
  Vector6d solve(const Vector6d& b) const {
    Vector6d x = solveLower(b).cwiseProduct(inverse_pivots_);
#pragma GCC unroll 6
    for (int i = 4; i >= 0; --i) {
#pragma GCC unroll 6
      for (int k = i + 1; k < 6; ++k) {
        x[i] -= lower_(k, i) * x[k];
      }
    }
    return x;
  }

  Matrix6d inverse() const {
    Matrix6d lower_inverse = Matrix6d::Identity();
#pragma GCC unroll 6
    for (int j = 0; j < 6; ++j) {
#pragma GCC unroll 6
      for (int i = j + 1; i < 6; ++i) {
        double sum = 0.0;
#pragma GCC unroll 6
        for (int k = j; k < i; ++k) {
          sum -= lower_(i, k) * lower_inverse(k, j);
        }
        lower_inverse(i, j) = sum;
      }
    }
    // L^-T D^-1 L^-1, of which column i of L^-1 starts in row i.
    Matrix6d inverse;
#pragma GCC unroll 6
    for (int i = 0; i < 6; ++i) {
#pragma GCC unroll 6
      for (int j = 0; j <= i; ++j) {
        double sum = 0.0;
#pragma GCC unroll 6
        for (int k = i; k < 6; ++k) {
          sum += lower_inverse(k, i) * inverse_pivots_[k] * lower_inverse(k, j);
        }
        inverse(i, j) = sum;
        inverse(j, i) = sum;
      }
    }
    return inverse;
  }

 private:
  Vector6d solveLower(const Vector6d& b) const {
    Vector6d y = b;
#pragma GCC unroll 6
    for (int i = 1; i < 6; ++i) {
#pragma GCC unroll 6
      for (int k = 0; k < i; ++k) {
        y[i] -= lower_(i, k) * y[k];
      }
    }
    return y;
  }

  Matrix6d lower_;  // below the diagonal
  Vector6d diagonal_, pivots_, inverse_pivots_;
};

}  // namespace hmcdyn::detail

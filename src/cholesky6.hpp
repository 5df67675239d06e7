// SPDX-License-Identifier: BSD-3-Clause
// Cholesky's factorisation of a 6x6 matrix with all loops unrolled. Eigen's is written for any size
// and takes several times as long here, which shows: a pose of 50 points factorises ten times.
#pragma once

#include <array>
#include <cmath>

#include <Eigen/Core>

namespace hmcdyn::detail {

/// H = L L^T. Has the interface that ceres::TinySolver expects of a linear solver.
class Cholesky6 {
 public:
  using Matrix6d = Eigen::Matrix<double, 6, 6>;
  using Vector6d = Eigen::Matrix<double, 6, 1>;

  /// Reads the lower triangle. A matrix that is not positive definite gives smallestPivot() <= 0
  /// or NaN, and solutions that mean nothing.
  void compute(const Matrix6d& h) {
    smallest_pivot_ = 1.0;
#pragma GCC unroll 6
    for (int j = 0; j < 6; ++j) {
      double pivot = h(j, j);
#pragma GCC unroll 6
      for (int k = 0; k < j; ++k) {
        pivot -= lower_(j, k) * lower_(j, k);
      }
      // Not std::min: a NaN has to stay.
      smallest_pivot_ = pivot >= smallest_pivot_ * h(j, j) ? smallest_pivot_ : pivot / h(j, j);
      const double root = std::sqrt(pivot);
      lower_(j, j) = root;
      inverse_diagonal_[static_cast<std::size_t>(j)] = 1.0 / root;
#pragma GCC unroll 6
      for (int i = j + 1; i < 6; ++i) {
        double sum = h(i, j);
#pragma GCC unroll 6
        for (int k = 0; k < j; ++k) {
          sum -= lower_(i, k) * lower_(j, k);
        }
        lower_(i, j) = sum * inverse_diagonal_[static_cast<std::size_t>(j)];
      }
    }
  }

  /// The least share of a diagonal entry of H that the columns before it leave: 1 for a diagonal
  /// matrix, 0 for a singular one, whatever the units of its rows.
  double smallestPivot() const { return smallest_pivot_; }

  /// The strict upper triangle is not defined.
  const Matrix6d& lower() const { return lower_; }

  /// L^-1 b
  Vector6d solveLower(const Vector6d& b) const {
    Vector6d y;
#pragma GCC unroll 6
    for (int i = 0; i < 6; ++i) {
      double sum = b[i];
#pragma GCC unroll 6
      for (int k = 0; k < i; ++k) {
        sum -= lower_(i, k) * y[k];
      }
      y[i] = sum * inverse_diagonal_[static_cast<std::size_t>(i)];
    }
    return y;
  }

  /// H^-1 b
  Vector6d solve(const Vector6d& b) const {
    Vector6d x = solveLower(b);
#pragma GCC unroll 6
    for (int i = 5; i >= 0; --i) {
#pragma GCC unroll 6
      for (int k = i + 1; k < 6; ++k) {
        x[i] -= lower_(k, i) * x[k];
      }
      x[i] *= inverse_diagonal_[static_cast<std::size_t>(i)];
    }
    return x;
  }

 private:
  Matrix6d lower_;
  std::array<double, 6> inverse_diagonal_{};
  double smallest_pivot_ = 0.0;
};

}  // namespace hmcdyn::detail

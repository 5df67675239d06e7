// SPDX-License-Identifier: BSD-3-Clause
// A small matrix whose memory looks the same to every compiler and under every flag.
#pragma once

#include <array>
#include <cstddef>

#include <Eigen/Core>

#include <hmcdyn/detail/requirements.hpp>

namespace hmcdyn {

/// A matrix of double, row by row, as the library and its user exchange it. Eigen's own matrices
/// have no one layout: their alignment, and the size of what holds them, depend on -mavx2 or
/// -march=native, and the library's flags need not be the user's. Converts from and to Eigen's, in
/// which to compute.
template <int kRows, int kColumns>
struct PlainMatrix {
  /// Rows times columns.
  static constexpr std::size_t kSize =
      static_cast<std::size_t>(kRows) * static_cast<std::size_t>(kColumns);

  std::array<double, kSize> values{};  ///< The elements, row by row.

  PlainMatrix() = default;  ///< Zeros.
  /// From the elements, row by row.
  explicit PlainMatrix(const std::array<double, kSize>& all) : values(all) {}
  /// From any matrix or expression of Eigen of this size.
  template <class Derived>
  // NOLINTNEXTLINE(google-explicit-constructor,hicpp-explicit-conversions): stands for the other
  PlainMatrix(const Eigen::MatrixBase<Derived>& matrix) {
    Eigen::Map<RowMajor>(values.data()) = matrix;
  }
  /// To Eigen's.
  // NOLINTNEXTLINE(google-explicit-constructor,hicpp-explicit-conversions): stands for the other
  operator Eigen::Matrix<double, kRows, kColumns>() const { return map(); }

  /// The elements where they are, as Eigen takes them: `covariance->map().diagonal()`.
  auto map() const { return Eigen::Map<const RowMajor>(values.data()); }

  /// The element of a row and a column, from 0 on; not checked.
  double operator()(int row, int column) const {
    return values[static_cast<std::size_t>(row * kColumns + column)];
  }
  /// The same, to write to.
  double& operator()(int row, int column) {
    return values[static_cast<std::size_t>(row * kColumns + column)];
  }

  /// Element by element, without a tolerance.
  friend bool operator==(const PlainMatrix& a, const PlainMatrix& b) {
    return a.values == b.values;
  }
  /// The opposite.
  friend bool operator!=(const PlainMatrix& a, const PlainMatrix& b) { return !(a == b); }

 private:
  using RowMajor = Eigen::Matrix<double, kRows, kColumns, Eigen::RowMajor>;
};

}  // namespace hmcdyn

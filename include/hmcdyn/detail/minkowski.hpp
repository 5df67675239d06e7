// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Core>

namespace hmcdyn::detail {

/// The neighbourhood of eq. 6, as a test that every clustering backend shares, so that all agree on
/// ties: two points are neighbours when their Minkowski distance is at most the radius. Distances
/// are compared as powers (sum |x - y|^p), in single precision.
class MinkowskiBall {
 public:
  MinkowskiBall(float order, float radius)
      : order_(order), radius_(radius), scale_(std::ldexp(1.0f, -std::ilogb(radius))) {
    if (std::isinf(order) || order == 1.0f) {
      power_ = radius;
    } else if (order == 2.0f) {
      power_ = radius * radius;
      square_limit_ = 2.0f * power_;
    } else {
      power_ = std::pow(scale_ * radius, order);
    }
  }

  /// sum |x - y|^p, eq. 6 without the root; max |x - y| for p = infinity. For p other than 1, 2 and
  /// infinity in units in which the radius lies in [1, 2), so that no power of it leaves float's
  /// range; a power of two, so that exact differences stay exact.
  float power(const float* x, const float* y, Eigen::Index dimensions) const {
    float sum = 0.0f;
    for (Eigen::Index k = 0; k < dimensions; ++k) {
      const float difference = std::abs(x[k] - y[k]);
      if (order_ == 2.0f) {
        sum += boundedSquare(difference);
      } else if (order_ == 1.0f) {
        sum += difference;
      } else if (std::isinf(order_)) {
        sum = std::max(sum, difference);
      } else {
        sum += std::pow(scale_ * difference, order_);
      }
    }
    return sum;
  }

  bool contains(float power) const { return power <= power_; }

  /// Side of a cube in which any two points are neighbours, without a margin for rounding.
  double sideOfNeighbours(Eigen::Index dimensions) const {
    return std::isinf(order_)
               ? static_cast<double>(radius_)
               : static_cast<double>(radius_) /
                     std::pow(static_cast<double>(dimensions), 1.0 / static_cast<double>(order_));
  }

  /// Squared radius of a Euclidean ball that holds this one, with a margin for rounding: a kd-tree
  /// with the Euclidean metric serves every order.
  float enclosingSquaredRadius(Eigen::Index dimensions) const {
    const double excess = std::isinf(order_) ? 0.5 : 0.5 - 1.0 / static_cast<double>(order_);
    const double factor =
        excess > 0.0 ? std::pow(static_cast<double>(dimensions), excess) : 1.0;  // p > 2
    const double radius = static_cast<double>(radius_) * factor * (1.0 + 1e-5);
    // The smallest normal number: a squared radius of a tiny ball must not vanish.
    return static_cast<float>(radius * radius) + std::numeric_limits<float>::min();
  }

 private:
  /// A square beyond the radius may come out smaller, but beyond the radius. With the limit in
  /// between, no compiler fuses product and sum, which would round differently.
  float boundedSquare(float difference) const {
    const float square = difference * difference;
    return square < square_limit_ ? square : square_limit_;
  }

  float order_;
  float radius_;
  float scale_;
  float power_ = 0.0f;
  float square_limit_ = 0.0f;
};

}  // namespace hmcdyn::detail

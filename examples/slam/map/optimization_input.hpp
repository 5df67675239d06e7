// SPDX-License-Identifier: BSD-3-Clause
// What every optimisation of this folder refuses in its input.
#pragma once

#include <cmath>
#include <stdexcept>
#include <string>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace hmcdyn::slam {

/// @throws std::invalid_argument "<argument> is <value>, expected <expected>" unless `good`.
inline void require(bool good, const std::string& argument, const std::string& value,
                    const std::string& expected) {
  if (!good) {
    throw std::invalid_argument(argument + " is " + value + ", expected " + expected);
  }
}

inline void requirePositive(const std::string& argument, double value) {
  require(std::isfinite(value) && value > 0.0, argument, std::to_string(value), "finite and > 0");
}

inline void requireNotNegative(const std::string& argument, double value) {
  require(std::isfinite(value) && value >= 0.0, argument, std::to_string(value), "finite and >= 0");
}

inline void requireAtLeast(const std::string& argument, int value, int least) {
  require(value >= least, argument, std::to_string(value), "at least " + std::to_string(least));
}

inline void requireIndex(const std::string& argument, int value, std::size_t size) {
  require(value >= 0 && static_cast<std::size_t>(value) < size, argument, std::to_string(value),
          "an index below " + std::to_string(size));
}

inline void requireRigid(const std::string& argument, const Eigen::Isometry3d& pose) {
  require(pose.matrix().allFinite(), argument, "not finite", "a rigid motion");
  const Eigen::Matrix3d rotation = pose.linear();
  const double error = (rotation.transpose() * rotation - Eigen::Matrix3d::Identity()).norm();
  constexpr double kLargestError = 1e-3;  // as refinePose() takes it
  require(error <= kLargestError && rotation.determinant() > 0.0, argument, "not a rigid motion",
          "a rotation and a translation");
}

}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
// What is known of the motion between two poses, as a residual, and its derivatives.
#pragma once

#include <string>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <ceres/cost_function.h>

namespace hmcdyn::slam {

/// S with S^T S = information.
/// @throws std::invalid_argument naming the argument unless it is finite, symmetric and positive
///   semidefinite.
Eigen::Matrix<double, 6, 6> squareRootOf(const Eigen::Matrix<double, 6, 6>& information,
                                         const std::string& argument);

/// S d with S^T S = information, d = (Log R, t) of T_to T_from^-1 to_from^-1; blocks: from, to.
class RelativePoseCost final : public ceres::CostFunction {
 public:
  /// @param square_root S.
  RelativePoseCost(const Eigen::Isometry3d& to_from,
                   const Eigen::Matrix<double, 6, 6>& square_root);
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  Eigen::Isometry3d from_to_;
  Eigen::Matrix<double, 6, 6> square_root_;
};

}  // namespace hmcdyn::slam

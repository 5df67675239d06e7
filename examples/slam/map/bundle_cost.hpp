// SPDX-License-Identifier: BSD-3-Clause
// The residual of one observation in a bundle adjustment and its derivatives.
#pragma once

#include <Eigen/Core>
#include <ceres/cost_function.h>
#include <ceres/sized_cost_function.h>

#include <hmcdyn/types.hpp>

#include "slam/map/bundle_adjustment.hpp"

namespace hmcdyn::slam {

/// What the observations have in common.
struct BundleModel {
  PinholeCamera camera;
  double min_depth = 0.05;  ///< m
};

/// An observation in the rows of the model.
struct BundleMeasurement {
  Eigen::Vector3d observed = Eigen::Vector3d::Zero();       ///< u, v (px), depth (m)
  Eigen::Vector3d inverse_sigma = Eigen::Vector3d::Zero();  ///< 1/px, 1/px, 1/m
  int rows = 2;                                             ///< 2 or 3
};

BundleMeasurement measurementOf(const BundleObservation& observation, const BundleOptions& options);

/// e of a point in the camera's frame whose depths have an offset (1/m); a row beyond
/// measurement.rows is 0.
Eigen::Vector3d bundleResidual(const BundleMeasurement& measurement, const BundleModel& model,
                               const Eigen::Vector3d& in_camera, double depth_offset);

/// A point as Ceres holds it: x, y, z (m, world), offset of its depths (1/m).
inline constexpr int kPointSize = 4;
using PointVector = Eigen::Matrix<double, kPointSize, 1>;

/// e and its derivatives by the pose's delta, see se3::Manifold, and by the point with its offset.
///
/// Nearer than min_depth the perspective division is by min_depth. The cost stays finite and
/// continuous there: one point that a step would bring behind a camera must not hold up the
/// thousand others, as a refused evaluation would.
class BundleCost final : public ceres::CostFunction {
 public:
  BundleCost(const BundleMeasurement& measurement, const BundleModel& model);
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  BundleMeasurement measurement_;
  BundleModel model_;
};

/// The offset of a point's depths in standard deviations of the camera's systematic error.
class DepthOffsetPrior final : public ceres::SizedCostFunction<1, kPointSize> {
 public:
  /// @param sigma (1/m), > 0.
  explicit DepthOffsetPrior(double sigma) : inverse_sigma_(1.0 / sigma) {}
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  double inverse_sigma_;
};

}  // namespace hmcdyn::slam

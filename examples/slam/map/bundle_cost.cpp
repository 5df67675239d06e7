// SPDX-License-Identifier: BSD-3-Clause
#include "slam/map/bundle_cost.hpp"

#include <algorithm>

#include <Eigen/Geometry>

#include "se3.hpp"

namespace hmcdyn::slam {

BundleMeasurement measurementOf(const BundleObservation& observation,
                                const BundleOptions& options) {
  BundleMeasurement measurement;
  const double sigma = observation.sigma;
  measurement.observed << observation.u, observation.v, 0.0;
  measurement.inverse_sigma << 1.0 / sigma, 1.0 / sigma, 0.0;
  if (hasDepth(observation.depth)) {
    const double depth = observation.depth;
    measurement.rows = 3;
    measurement.observed.z() = depth;
    measurement.inverse_sigma.z() =
        1.0 / (observation.depth_sigma > 0.0f ? static_cast<double>(observation.depth_sigma)
                                              : relativeDepthError(depth, options.depth_error));
  }
  return measurement;
}

Eigen::Vector3d bundleResidual(const BundleMeasurement& measurement, const BundleModel& model,
                               const Eigen::Vector3d& in_camera, double depth_offset) {
  const double inverse_z = 1.0 / std::max(in_camera.z(), model.min_depth);
  const Eigen::Vector3d predicted(model.camera.fx * in_camera.x() * inverse_z + model.camera.cx,
                                  model.camera.fy * in_camera.y() * inverse_z + model.camera.cy,
                                  in_camera.z() + depth_offset * in_camera.z() * in_camera.z());
  return measurement.inverse_sigma.cwiseProduct(measurement.observed - predicted);
}

BundleCost::BundleCost(const BundleMeasurement& measurement, const BundleModel& model)
    : measurement_(measurement), model_(model) {
  set_num_residuals(measurement.rows);
  *mutable_parameter_block_sizes() = {se3::kPoseSize, kPointSize};
}

bool BundleCost::Evaluate(double const* const* parameters, double* residuals,
                          double** jacobians) const {
  const Eigen::Matrix3d rotation =
      Eigen::Map<const Eigen::Quaterniond>(parameters[0]).toRotationMatrix();
  const Eigen::Map<const Eigen::Vector3d> translation(parameters[0] + 4);
  const Eigen::Map<const Eigen::Vector3d> point(parameters[1]);
  const Eigen::Vector3d p = rotation * point + translation;
  const int rows = measurement_.rows;
  const double offset = parameters[1][3];
  const Eigen::Vector3d residual = bundleResidual(measurement_, model_, p, offset);
  std::copy_n(residual.data(), rows, residuals);
  if (jacobians == nullptr) {
    return true;
  }

  const double inverse_z = 1.0 / std::max(p.z(), model_.min_depth);
  const double by_z = p.z() > model_.min_depth ? inverse_z * inverse_z : 0.0;
  const PinholeCamera& camera = model_.camera;
  Eigen::Matrix3d by_p;                                           // de/dp
  by_p << -camera.fx * inverse_z, 0.0, camera.fx * p.x() * by_z,  //
      0.0, -camera.fy * inverse_z, camera.fy * p.y() * by_z,      //
      0.0, 0.0, -1.0 - 2.0 * offset * p.z();
  by_p = measurement_.inverse_sigma.asDiagonal() * by_p.eval();
  if (jacobians[0] != nullptr) {
    for (int i = 0; i < rows; ++i) {
      const Eigen::Vector3d row = by_p.row(i);
      const Eigen::Vector3d by_omega = p.cross(row);  // row^T (-[p]x) = (p x row)^T
      double* out = jacobians[0] + i * se3::kPoseSize;
      std::copy_n(by_omega.data(), 3, out);
      std::copy_n(row.data(), 3, out + 3);
      out[6] = 0.0;
    }
  }
  if (jacobians[1] != nullptr) {
    Eigen::Matrix<double, 3, kPointSize, Eigen::RowMajor> by_point;
    by_point.leftCols<3>() = by_p * rotation;
    by_point.col(3) << 0.0, 0.0, -measurement_.inverse_sigma.z() * p.z() * p.z();
    std::copy_n(by_point.data(), kPointSize * rows, jacobians[1]);
  }
  return true;
}

bool DepthOffsetPrior::Evaluate(double const* const* parameters, double* residuals,
                                double** jacobians) const {
  residuals[0] = inverse_sigma_ * parameters[0][3];
  if (jacobians != nullptr && jacobians[0] != nullptr) {
    std::fill_n(jacobians[0], 3, 0.0);
    jacobians[0][3] = inverse_sigma_;
  }
  return true;
}

}  // namespace hmcdyn::slam

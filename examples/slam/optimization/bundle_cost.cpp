// SPDX-License-Identifier: BSD-3-Clause
#include "slam/optimization/bundle_cost.hpp"

#include <algorithm>

#include <Eigen/Geometry>

#include "slam/optimization/se3_manifold.hpp"

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
        1.0 / (options.depth_noise_floor + options.depth_noise_quadratic * depth * depth);
  }
  return measurement;
}

Eigen::Vector3d bundleResidual(const BundleMeasurement& measurement, const BundleModel& model,
                               const Eigen::Vector3d& in_camera) {
  const double inverse_z = 1.0 / std::max(in_camera.z(), model.min_depth);
  const Eigen::Vector3d predicted(model.camera.fx * in_camera.x() * inverse_z + model.camera.cx,
                                  model.camera.fy * in_camera.y() * inverse_z + model.camera.cy,
                                  in_camera.z());
  return measurement.inverse_sigma.cwiseProduct(measurement.observed - predicted);
}

BundleCost::BundleCost(const BundleMeasurement& measurement, const BundleModel& model)
    : measurement_(measurement), model_(model) {
  set_num_residuals(measurement.rows);
  *mutable_parameter_block_sizes() = {kPoseSize, 3};
}

bool BundleCost::Evaluate(double const* const* parameters, double* residuals,
                          double** jacobians) const {
  const Eigen::Matrix3d rotation =
      Eigen::Map<const Eigen::Quaterniond>(parameters[0]).toRotationMatrix();
  const Eigen::Map<const Eigen::Vector3d> translation(parameters[0] + 4);
  const Eigen::Map<const Eigen::Vector3d> point(parameters[1]);
  const Eigen::Vector3d p = rotation * point + translation;
  const int rows = measurement_.rows;
  const Eigen::Vector3d residual = bundleResidual(measurement_, model_, p);
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
      0.0, 0.0, -1.0;
  by_p = measurement_.inverse_sigma.asDiagonal() * by_p.eval();
  if (jacobians[0] != nullptr) {
    for (int i = 0; i < rows; ++i) {
      const Eigen::Vector3d row = by_p.row(i);
      const Eigen::Vector3d by_omega = p.cross(row);  // row^T (-[p]x) = (p x row)^T
      double* out = jacobians[0] + i * kPoseSize;
      std::copy_n(by_omega.data(), 3, out);
      std::copy_n(row.data(), 3, out + 3);
      out[6] = 0.0;
    }
  }
  if (jacobians[1] != nullptr) {
    const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> by_point = by_p * rotation;
    std::copy_n(by_point.data(), 3 * rows, jacobians[1]);
  }
  return true;
}

}  // namespace hmcdyn::slam

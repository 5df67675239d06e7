// SPDX-License-Identifier: BSD-3-Clause
// The whitened residual of one point and its Jacobian: all the geometry of eq. 9, without a solver.
#pragma once

#include <optional>

#include <Eigen/Core>

#include <hmcdyn/pose_refinement.hpp>
#include <hmcdyn/types.hpp>

namespace hmcdyn::detail {

/// The projection h, with its third row.
struct ProjectionModel {
  PinholeCamera camera;
  DepthRow depth_row = DepthRow::kNone;
  double baseline_fx = 0.0;  ///< bf (px m), for DepthRow::kDisparity.
  double min_depth = 0.0;    ///< m
};

/// One map point and its observation in the rows of the model.
struct PointMeasurement {
  Eigen::Vector3d world = Eigen::Vector3d::Zero();          ///< Z_i (m)
  Eigen::Vector3d observed = Eigen::Vector3d::Zero();       ///< z_i: u, v (px), third row
  Eigen::Vector3d inverse_sigma = Eigen::Vector3d::Zero();  ///< 0 switches a row off
  int rows = 2;                                             ///< 2 or 3
};

/// e = Q^-1/2 (z - h(R Z + t)) and de/d(omega, v) under (R, t) <- (Exp(omega) R, Exp(omega) t + v).
struct PointResidual {
  Eigen::Vector3d residual;
  Eigen::Matrix<double, 3, 6> jacobian;
};

/// None where the point is nearer than the model's min_depth or behind the camera. A row that is
/// switched off is zero in both.
inline std::optional<PointResidual> pointResidual(const PointMeasurement& measurement,
                                                  const ProjectionModel& model,
                                                  const Eigen::Matrix3d& rotation,
                                                  const Eigen::Vector3d& translation) {
  const Eigen::Vector3d p = rotation * measurement.world + translation;
  if (!(p.z() > 0.0 && p.z() >= model.min_depth)) {
    return std::nullopt;
  }
  const double inverse_z = 1.0 / p.z();
  const double x = p.x() * inverse_z;
  const double y = p.y() * inverse_z;
  const double fx = model.camera.fx;
  const double fy = model.camera.fy;

  Eigen::Vector3d predicted(fx * x + model.camera.cx, fy * y + model.camera.cy, 0.0);
  Eigen::Matrix3d predicted_by_point;  // dh/dp
  predicted_by_point.row(0) << fx * inverse_z, 0.0, -fx * x * inverse_z;
  predicted_by_point.row(1) << 0.0, fy * inverse_z, -fy * y * inverse_z;
  predicted_by_point.row(2).setZero();
  if (measurement.rows == 3 && model.depth_row == DepthRow::kDepth) {
    predicted.z() = p.z();
    predicted_by_point(2, 2) = 1.0;
  } else if (measurement.rows == 3) {
    const double disparity = model.baseline_fx * inverse_z;
    predicted.z() = predicted.x() - disparity;
    predicted_by_point.row(2) = predicted_by_point.row(0);
    predicted_by_point(2, 2) += disparity * inverse_z;
  }

  Eigen::Matrix<double, 3, 6> point_by_pose;           // dp/d(omega, v) = (-[p]x, I)
  point_by_pose << 0.0, p.z(), -p.y(), 1.0, 0.0, 0.0,  //
      -p.z(), 0.0, p.x(), 0.0, 1.0, 0.0,               //
      p.y(), -p.x(), 0.0, 0.0, 0.0, 1.0;

  PointResidual result;
  result.residual = measurement.inverse_sigma.cwiseProduct(measurement.observed - predicted);
  result.jacobian =
      -(measurement.inverse_sigma.asDiagonal() * predicted_by_point).eval() * point_by_pose;
  return result;
}

}  // namespace hmcdyn::detail

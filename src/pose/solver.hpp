// SPDX-License-Identifier: BSD-3-Clause
// One round of the pose refinement in Ceres: the manifold, the cost function, the losses.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <ceres/cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/version.h>

#include <hmcdyn/pose_refinement.hpp>

#include "pose/problem.hpp"
#include "pose/residual.hpp"

// The one place that knows which of Ceres' interfaces there is: Manifold came with 2.1,
// LocalParameterization left with 2.2.
#if CERES_VERSION_MAJOR > 2 || (CERES_VERSION_MAJOR == 2 && CERES_VERSION_MINOR >= 1)
#define HMCDYN_CERES_HAS_MANIFOLD
#include <ceres/manifold.h>
#else
#include <ceres/local_parameterization.h>
#endif

namespace hmcdyn::detail {

/// A pose as Ceres holds it: camera_from_world as (qx, qy, qz, qw, tx, ty, tz).
constexpr int kPoseSize = 7;
using PoseVector = Eigen::Matrix<double, kPoseSize, 1>;

PoseVector toPoseVector(const Eigen::Isometry3d& pose);
Eigen::Isometry3d toIsometry(const PoseVector& pose);

#ifdef HMCDYN_CERES_HAS_MANIFOLD
using PoseManifoldBase = ceres::Manifold;
#else
using PoseManifoldBase = ceres::LocalParameterization;
#endif

/// A step of a pose: delta = (omega, v) moves (R, t) to (Exp(omega) R, Exp(omega) t + v), a motion
/// in the camera's frame. The world's frame does not enter, so that the same problem told in
/// another world frame takes the same steps.
PoseVector moved(const PoseVector& pose, const Eigen::Matrix<double, 6, 1>& delta);

/// These steps for Ceres.
class PoseManifold final : public PoseManifoldBase {
 public:
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
#ifdef HMCDYN_CERES_HAS_MANIFOLD
  int AmbientSize() const override { return kPoseSize; }
  int TangentSize() const override { return 6; }
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y, const double* x, double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;
#else
  int GlobalSize() const override { return kPoseSize; }
  int LocalSize() const override { return 6; }
  bool ComputeJacobian(const double* x, double* jacobian) const override;
#endif
};

/// Eq. 9 of one point, without its weight: the weight belongs to the loss.
class PointCost final : public ceres::CostFunction {
 public:
  PointCost(const PointMeasurement& measurement, const ProjectionModel& model);
  /// False, which Ceres answers with a shorter step, where the point is not in front.
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  PointMeasurement measurement_;
  ProjectionModel model_;
};

/// A point that may take part: finite and of positive weight.
struct WeightedPoint {
  std::size_t index = 0;  ///< In the caller's arrays.
  double weight = 1.0;    ///< lambda_i as given.
  bool switchable = false;
  PointMeasurement measurement;
};

/// lambda^2 rho of a point; `robust` = false leaves Huber's out.
std::unique_ptr<ceres::LossFunction> makeLoss(const WeightedPoint& point,
                                              const PoseRefinementOptions& options, bool robust);

struct PoseOutcome {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  SolverOutcome outcome;  ///< Without its message.
  std::string message;
};

/// Minimises sum lambda_i^2 rho(|e_i|^2) over the points with active[i] != 0, all of which must
/// be in front of the camera at `start`.
PoseOutcome solvePose(const std::vector<WeightedPoint>& points,
                      const std::vector<std::uint8_t>& active, const ProjectionModel& model,
                      const PoseRefinementOptions& options, bool robust,
                      const Eigen::Isometry3d& start);

}  // namespace hmcdyn::detail

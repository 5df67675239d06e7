// SPDX-License-Identifier: BSD-3-Clause
// One round of the pose refinement in Ceres: the cost function, the losses.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <ceres/cost_function.h>
#include <ceres/loss_function.h>

#include <hmcdyn/pose_refinement.hpp>

#include "pose/problem.hpp"
#include "pose/residual.hpp"

namespace hmcdyn::detail {

/// Eq. 9 of one point, without its weight: the weight belongs to the loss. Goes with se3::Manifold.
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

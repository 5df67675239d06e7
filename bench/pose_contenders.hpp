// SPDX-License-Identifier: BSD-3-Clause
// What refinePose() is measured against: eq. 10 with Huber's loss as a user would write it.
#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <hmcdyn/pose_refinement.hpp>
#include <hmcdyn/types.hpp>

namespace hmcdyn::bench {

/// One problem: structure of arrays for refinePose(), sigma 1.
struct PoseInput {
  PinholeCamera camera{535.4, 539.2, 320.1, 247.6};
  Eigen::Isometry3d initial = Eigen::Isometry3d::Identity();
  std::vector<float> x, y, z, u, v, weight;

  PoseObservations view() const { return {x, y, z, u, v, {}, {}, weight}; }
};

/// sum lambda^2 rho(|e|^2) with PoseRefinementOptions' Huber threshold for two rows.
double robustCost(const PoseInput& input, const Eigen::Isometry3d& pose);
/// sum |e|^2
double plainCost(const PoseInput& input, const Eigen::Isometry3d& pose);

/// ceres::Problem with one residual block a point and analytic Jacobians on SE(3): build and solve.
Eigen::Isometry3d solveWithCeres(const PoseInput& input, double tolerance);

/// The same with ceres::AutoDiffCostFunction on (angle axis, translation).
Eigen::Isometry3d solveWithCeresAutoDiff(const PoseInput& input, double tolerance);

/// ceres::TinySolver over the 2 N residuals, analytic Jacobian on (angle axis, translation). Its
/// matrices are kept from call to call, which is how it is meant to be used. TinySolver knows no
/// loss: each residual is scaled such that its square is the loss.
class TinySolverOverAllResiduals {
 public:
  TinySolverOverAllResiduals();
  Eigen::Isometry3d operator()(const PoseInput& input, double tolerance) const;

 private:
  struct Solver;
  std::shared_ptr<Solver> solver_;
};

/// cv::solvePnPRefineLM, whose tolerance is one on the step.
Eigen::Isometry3d solveWithOpenCv(const PoseInput& input, double tolerance, int iterations = 100);

/// The same with the criteria that OpenCV gives it where the caller names none.
Eigen::Isometry3d solveWithOpenCvDefaults(const PoseInput& input);

}  // namespace hmcdyn::bench

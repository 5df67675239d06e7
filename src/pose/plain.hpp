// SPDX-License-Identifier: BSD-3-Clause
// PoseSolver::kCeresProblem: one residual block a point, the whole of it left to Ceres.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <hmcdyn/pose_refinement.hpp>

#include "pose/problem.hpp"
#include "pose/residual.hpp"
#include "pose/solver.hpp"

namespace hmcdyn::detail {

class PlainPoseProblem final : public PoseProblem {
 public:
  PlainPoseProblem(const PoseObservations& observations, const PinholeCamera& camera,
                   const PoseRefinementOptions& options);

  std::size_t notFinite() const override { return not_finite_; }
  std::size_t start(const Eigen::Isometry3d& pose) override;
  SolverOutcome solve(bool robust) override;
  Eigen::Isometry3d pose() const override { return pose_; }
  Eigen::Matrix<double, 6, 6> information() const override;
  InlierTest testInliers() override;
  void activateInliers() override { active_ = inlier_; }
  void describePoints(PoseRefinementResult& result) const override;

 private:
  PoseRefinementOptions options_;
  ProjectionModel model_;
  std::vector<WeightedPoint> points_;
  std::size_t not_finite_ = 0;
  std::vector<std::uint8_t> active_;
  std::vector<std::uint8_t> inlier_;
  Eigen::Isometry3d pose_ = Eigen::Isometry3d::Identity();
  bool robust_ = false;
  std::string message_;  // Ceres' own of the last solve
};

}  // namespace hmcdyn::detail

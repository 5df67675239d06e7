// SPDX-License-Identifier: BSD-3-Clause
// PoseSolver::kCollapsed: each linearisation collapsed into seven residuals for ceres::TinySolver.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <hmcdyn/pose_refinement.hpp>

#include "pose/kernel.hpp"
#include "pose/problem.hpp"
#include "pose/residual.hpp"
#include "pose/solver.hpp"
#include "se3.hpp"

namespace hmcdyn::detail {

/// A pose and what one pass over the points found there.
struct Linearisation {
  se3::PoseVector pose = se3::PoseVector::Zero();
  CollapsedSystem system;
  std::vector<double> squared_residuals;  ///< As collapse() leaves them.
};

/// The points as the kernel reads them, and the camera that sees them.
struct CollapsedPoints {
  ProjectionModel model;
  std::vector<PointBlock> blocks;

  /// Fills `at.system` and `at.squared_residuals` for `at.pose`.
  void linearise(Linearisation& at, CollapseVariant variant) const;
};

/// Keeps its buffers from one assign() to the next.
class CollapsedPoseProblem final : public PoseProblem {
 public:
  void assign(const PoseObservations& observations, const PinholeCamera& camera,
              const PoseRefinementOptions& options);

  std::size_t notFinite() const override { return not_finite_; }
  std::size_t start(const Eigen::Isometry3d& pose) override;
  SolverOutcome solve(bool robust) override;
  Eigen::Isometry3d pose() const override { return se3::toIsometry(current_.pose); }
  Eigen::Matrix<double, 6, 6> information() const override { return current_.system.normal; }
  InlierTest testInliers() override;
  void activateInliers() override;
  void describePoints(PoseRefinementResult& result) const override;

 private:
  /// Counts the points that are not finite and finds those that may take part.
  void choosePoints(const PoseObservations& observations);
  /// Writes a field of every point: value(i) of the point's index in the caller's arrays.
  template <class Value>
  void fill(BlockField PointBlock::*field, const Value& value);
  void fillBlocks(const PoseObservations& observations);
  void fillThirdRow(const PoseObservations& observations);
  void fillSwitches(const PoseObservations& observations);
  std::size_t indexOf(std::size_t j) const { return index_.empty() ? j : index_[j]; }
  CollapseVariant variant(bool robust) const;
  void setActive(std::size_t i, bool active);

  PoseRefinementOptions options_;
  CollapsedPoints points_;
  bool some_switchable_ = false;
  std::size_t not_finite_ = 0;
  std::size_t count_ = 0;              // of the points that may take part
  std::vector<std::uint32_t> index_;   // in the caller's arrays; empty where all of them take part
  std::vector<double> square_weight_;  // lambda^2, active or not
  std::vector<double> limit_;          // of the 95 % test
  std::vector<std::uint8_t> active_;
  std::vector<std::uint8_t> inlier_;

  Linearisation current_;
  Linearisation candidate_;
  CollapseVariant current_variant_;
  bool current_is_valid_ = false;  // current_.system is that of the active points
};

}  // namespace hmcdyn::detail

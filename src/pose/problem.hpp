// SPDX-License-Identifier: BSD-3-Clause
// What the rounds of refinePose() ask of a solver. Its points are those that may take part: finite
// and of positive weight, in the caller's order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <hmcdyn/pose_refinement.hpp>

namespace hmcdyn::detail {

struct SolverOutcome {
  double initial_cost = 0.0;
  double final_cost = 0.0;
  int iterations = 0;
  bool usable = false;  ///< The pose is finite and no worse than the start.
  bool converged = false;
  std::string_view message;  ///< Until the next solve().
};

class PoseProblem {
 public:
  PoseProblem() = default;
  PoseProblem(const PoseProblem&) = default;
  PoseProblem(PoseProblem&&) = default;
  PoseProblem& operator=(const PoseProblem&) = default;
  PoseProblem& operator=(PoseProblem&&) = default;
  virtual ~PoseProblem() = default;

  /// Points left out for a NaN or infinite coordinate.
  virtual std::size_t notFinite() const = 0;
  /// Goes to a pose and makes the points in front of it the active ones; returns how many.
  virtual std::size_t start(const Eigen::Isometry3d& pose) = 0;
  /// Minimises sum lambda_i^2 rho(|e_i|^2) over the active points from the present pose, and goes
  /// to the minimum. `robust` = false leaves Huber's loss out.
  virtual SolverOutcome solve(bool robust) = 0;
  virtual Eigen::Isometry3d pose() const = 0;
  /// Gauss-Newton information of the active points at the present pose, with solve()'s losses.
  virtual Eigen::Matrix<double, 6, 6> information() const = 0;

  /// The 95 % test on the unweighted residuals of all points at the present pose.
  struct InlierTest {
    std::size_t inliers = 0;
    bool are_the_active = false;  ///< The inliers are exactly the active points.
  };
  virtual InlierTest testInliers() = 0;
  /// Makes the inliers of the last test the active points.
  virtual void activateInliers() = 0;

  /// Fills the result's `inlier` from the last test, and the `weight` of each suspect of the joint
  /// mode with lambda0 kappa / (kappa + |e|^2): where eq. 10 with the prior has its minimum.
  virtual void describePoints(PoseRefinementResult& result) const = 0;
};

}  // namespace hmcdyn::detail

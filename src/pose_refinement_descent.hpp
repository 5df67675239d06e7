// SPDX-License-Identifier: BSD-3-Clause
// The function that ceres::TinySolver minimises, and the one place that knows TinySolver's quirks
// in Ceres 1.14 to 2.2:
//   - It asks for the residuals at a candidate, then, if it takes the step, for residuals and
//     Jacobian there. One pass gives both, so the second call finds the first one's result.
//   - It knows no manifold. It gets the sum of the steps taken instead of a pose; each step is
//     applied to the pose of the last linearisation, as Ceres does with a manifold.
//   - It ignores a cost function that returns false. Infinite residuals make it refuse a step.
//   - Its function tolerance is absolute (and came with 2.1), its gradient tolerance is one on
//     the scaled gradient. So the tolerances are tested here, as ceres::Solver tests them, and a
//     Jacobian of zero, or residuals that no longer change, tell it to stop.
//   - max_num_iterations = n ends it after n - 1 steps.
#pragma once

#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Core>
#include <ceres/tiny_solver.h>

#include <hmcdyn/pose_refinement.hpp>

#include "pose_refinement_collapsed.hpp"
#include "pose_refinement_square_root.hpp"

namespace hmcdyn::detail {

/// One descent from current.pose.
struct Descent {
  const CollapsedPoints* points = nullptr;
  const PoseRefinementOptions* options = nullptr;
  CollapseVariant variant;
  Linearisation* current = nullptr;    ///< Where TinySolver linearised last.
  Linearisation* candidate = nullptr;  ///< Where it considers to go.

  Eigen::Matrix<double, 6, 1> current_steps = Eigen::Matrix<double, 6, 1>::Zero();
  Eigen::Matrix<double, 6, 1> candidate_steps = Eigen::Matrix<double, 6, 1>::Zero();
  Eigen::Matrix<double, 7, 1> residuals = Eigen::Matrix<double, 7, 1>::Zero();  ///< At `current`.
  int iterations = 0;
  const char* stop = nullptr;  ///< The tolerance that was met.
};

class DescentFunction {
 public:
  using Scalar = double;
  enum { NUM_RESIDUALS = 7, NUM_PARAMETERS = 6 };

  explicit DescentFunction(Descent& descent) : descent_(&descent) {}

  bool operator()(const double* steps, double* residuals, double* jacobian) const {
    const Eigen::Map<const Eigen::Matrix<double, 6, 1>> at(steps);
    Eigen::Map<Eigen::Matrix<double, 7, 1>> r(residuals);
    if (jacobian == nullptr) {
      r = consider(at);
      return true;
    }
    arriveAt(at);
    SquareRootSystem root = squareRootOf(descent_->current->system);
    // Ceres halves the cost, not its gradient.
    if (descent_->current->system.gradient.lpNorm<Eigen::Infinity>() <
        descent_->options->gradient_tolerance) {
      descent_->stop = "gradient_tolerance";
    }
    if (descent_->stop != nullptr) {
      root.jacobian.setZero();
    }
    descent_->residuals = root.residuals;
    r = root.residuals;
    Eigen::Map<Eigen::Matrix<double, 7, 6>>{jacobian} = root.jacobian;
    return true;
  }

  /// Makes a candidate that was accepted the current linearisation.
  void arriveAt(const Eigen::Matrix<double, 6, 1>& steps) const {
    if (steps != descent_->current_steps && steps == descent_->candidate_steps) {
      std::swap(*descent_->current, *descent_->candidate);
      descent_->current_steps = steps;
    }
  }

 private:
  Eigen::Matrix<double, 7, 1> consider(const Eigen::Matrix<double, 6, 1>& steps) const {
    Descent& d = *descent_;
    if (d.stop != nullptr) {
      return d.residuals;
    }
    const Eigen::Matrix<double, 6, 1> step = steps - d.current_steps;
    PoseManifold().Plus(d.current->pose.data(), step.data(), d.candidate->pose.data());
    d.points->linearise(*d.candidate, d.variant);
    d.candidate_steps = steps;
    ++d.iterations;
    const double cost = d.current->system.cost;
    const double new_cost = d.candidate->system.cost;
    if (std::abs(cost - new_cost) <= d.options->function_tolerance * cost) {
      d.stop = "function_tolerance";
      if (new_cost >= cost) {
        return d.residuals;
      }
    }
    return std::sqrt(new_cost) * Eigen::Matrix<double, 7, 1>::Unit(6);
  }

  Descent* descent_;
};

using DescentSolver = ceres::TinySolver<DescentFunction>;

// TinySolver's own function tolerance, where there is one.
template <class Options>
auto stopAtUnchangedCost(Options& options, int /*preferred*/)
    -> decltype(void(options.function_tolerance)) {
  options.function_tolerance = std::numeric_limits<double>::min();
}
template <class Options>
void stopAtUnchangedCost(Options& /*options*/, long /*otherwise*/) {}

/// Runs TinySolver; the minimum is then descent.current. `steps` starts with the norm of the
/// pose, which is what a relative step is relative to.
inline void descend(Descent& descent) {
  descent.current_steps << 1.0, 0.0, 0.0, descent.current->pose.tail<3>();
  Eigen::Matrix<double, 6, 1> steps = descent.current_steps;
  const DescentFunction function(descent);
  DescentSolver solver;
  solver.options.max_num_iterations = descent.options->max_iterations + 1;
  solver.options.gradient_tolerance = std::numeric_limits<double>::min();
  solver.options.parameter_tolerance = descent.options->parameter_tolerance;
  solver.options.cost_threshold = 0.0;
  stopAtUnchangedCost(solver.options, 0);
  solver.Solve(function, &steps);
  function.arriveAt(steps);
  if (descent.stop == nullptr &&
      solver.summary.status == DescentSolver::RELATIVE_STEP_SIZE_TOO_SMALL) {
    descent.stop = "parameter_tolerance";
  }
}

}  // namespace hmcdyn::detail

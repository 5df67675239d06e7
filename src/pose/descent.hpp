// SPDX-License-Identifier: BSD-3-Clause
// The function that ceres::TinySolver minimises, and the one place that knows TinySolver's quirks
// in Ceres 1.14 to 2.2:
//   - It asks for the residuals at a candidate, then, if it takes the step, for residuals and
//     Jacobian there. One pass gives both, so the second call finds the first one's result.
//   - It knows no manifold. It gets the sum of the steps taken instead of a pose; each step is
//     applied to the pose of the last linearisation, as Ceres does with a manifold.
//   - It ignores a cost function that returns false. Infinite residuals make it refuse a step.
//   - Its function tolerance is absolute (and came with 2.1), its gradient tolerance is one on
//     the scaled gradient. So both are tested here, as ceres::Solver tests them. Once one is met,
//     residuals of zero make it take the step, and a Jacobian of zero makes it stop there.
//   - max_num_iterations = n ends it after n - 1 steps.
#pragma once

#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Core>
#include <ceres/tiny_solver.h>

#include <hmcdyn/pose_refinement.hpp>

#include "pose/cholesky6.hpp"
#include "pose/collapsed.hpp"
#include "pose/square_root.hpp"
#include "se3.hpp"

namespace hmcdyn::detail {

/// One descent from current.pose.
struct Descent {
  const CollapsedPoints* points = nullptr;
  const PoseRefinementOptions* options = nullptr;
  CollapseVariant variant;
  Linearisation* current = nullptr;    ///< Where TinySolver linearised last: the minimum, then.
  Linearisation* candidate = nullptr;  ///< Where it considers to go.

  Eigen::Matrix<double, 6, 1> current_steps = Eigen::Matrix<double, 6, 1>::Zero();
  int iterations = 0;
  const char* stop = nullptr;  ///< Which tolerance was met, in words.
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
    Eigen::Map<Eigen::Matrix<double, 7, 6>> j(jacobian);
    Descent& d = *descent_;
    if (d.stop == nullptr) {
      arriveAt(at);
      const CollapsedSystem& system = d.current->system;
      r = squareRootOf(system, j);
      if (system.gradient.lpNorm<Eigen::Infinity>() < d.options->gradient_tolerance) {
        d.stop = "gradient_tolerance reached";
      } else if (r.head<6>().squaredNorm() <= d.options->function_tolerance * system.cost) {
        d.stop = "function_tolerance reached";  // it is all that a step can gain
      }
    }
    if (d.stop != nullptr) {
      r = std::sqrt(d.current->system.cost) * Eigen::Matrix<double, 7, 1>::Unit(6);
      j.setZero();
    }
    return true;
  }

 private:
  /// TinySolver linearises at its start, and then at each candidate that it has accepted.
  void arriveAt(const Eigen::Matrix<double, 6, 1>& steps) const {
    Descent& d = *descent_;
    if (steps != d.current_steps) {
      std::swap(d.current, d.candidate);
      d.current_steps = steps;
    }
  }

  Eigen::Matrix<double, 7, 1> consider(const Eigen::Matrix<double, 6, 1>& steps) const {
    Descent& d = *descent_;
    if (d.stop != nullptr) {
      return Eigen::Matrix<double, 7, 1>::Zero();
    }
    d.candidate->pose = se3::moved(d.current->pose, steps - d.current_steps);
    d.points->linearise(*d.candidate, d.variant);
    ++d.iterations;
    const double cost = d.current->system.cost;
    const double new_cost = d.candidate->system.cost;
    if (std::abs(cost - new_cost) <= d.options->function_tolerance * cost) {
      d.stop = "function_tolerance reached";
      // At the minimum the last bits decide which cost is lower. The step is taken all the same:
      // which pose is returned must not depend on them.
      constexpr double kRounding = 1e-12;
      if (new_cost <= (1.0 + kRounding) * cost) {
        arriveAt(steps);
      }
      return Eigen::Matrix<double, 7, 1>::Zero();
    }
    return std::sqrt(new_cost) * Eigen::Matrix<double, 7, 1>::Unit(6);
  }

  Descent* descent_;
};

using DescentSolver = ceres::TinySolver<DescentFunction, Cholesky6>;

/// Switches TinySolver's own function tolerance off, where there is one.
template <class Options>
auto ignoreCostChange(Options& options, int /*preferred*/)
    -> decltype(void(options.function_tolerance)) {
  options.function_tolerance = 0.0;
}
template <class Options>
void ignoreCostChange(Options& /*options*/, long /*otherwise*/) {}

/// Runs TinySolver; the minimum is then descent.current. A relative step is relative to the sum of
/// the steps so far, which is stricter than ceres::Solver's, the norm of the pose.
inline void descend(Descent& descent) {
  Eigen::Matrix<double, 6, 1> steps = descent.current_steps;  // zero
  const DescentFunction function(descent);
  DescentSolver solver;
  solver.options.max_num_iterations = descent.options->max_iterations + 1;
  solver.options.gradient_tolerance = std::numeric_limits<double>::min();
  solver.options.parameter_tolerance = descent.options->parameter_tolerance;
  solver.options.cost_threshold = 0.0;
  ignoreCostChange(solver.options, 0);
  solver.Solve(function, &steps);
  if (descent.stop == nullptr &&
      solver.summary.status == DescentSolver::RELATIVE_STEP_SIZE_TOO_SMALL) {
    descent.stop = "parameter_tolerance reached";
  }
}

}  // namespace hmcdyn::detail

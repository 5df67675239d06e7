// SPDX-License-Identifier: BSD-3-Clause
#include "pose/solver.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <ceres/problem.h>
#include <ceres/solver.h>

#include "se3.hpp"
#include "se3_manifold.hpp"

namespace hmcdyn::detail {
namespace {

/// What is left of the joint problem when each lambda has been eliminated: kappa s / (kappa + s),
/// Geman and McClure's loss, of which Ceres has none.
class SwitchLoss final : public ceres::LossFunction {
 public:
  explicit SwitchLoss(double kappa) : kappa_(kappa) {}
  void Evaluate(double s, double rho[3]) const override {
    const double share = kappa_ / (kappa_ + s);  // lambda / lambda0
    rho[0] = share * s;
    rho[1] = share * share;
    rho[2] = -2.0 * share * share / (kappa_ + s);
  }

 private:
  double kappa_;
};

ceres::Solver::Options solverOptions(const PoseRefinementOptions& options) {
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  solver.logging_type = ceres::SILENT;
  solver.num_threads = 1;
  solver.max_num_iterations = options.max_iterations;
  solver.function_tolerance = options.function_tolerance;
  solver.gradient_tolerance = options.gradient_tolerance;
  solver.parameter_tolerance = options.parameter_tolerance;
  return solver;
}

}  // namespace

PointCost::PointCost(const PointMeasurement& measurement, const ProjectionModel& model)
    : measurement_(measurement), model_(model) {
  set_num_residuals(measurement.rows);
  mutable_parameter_block_sizes()->push_back(se3::kPoseSize);
}

bool PointCost::Evaluate(double const* const* parameters, double* residuals,
                         double** jacobians) const {
  const double* pose = parameters[0];
  const auto evaluated = pointResidual(
      measurement_, model_, se3::rotationOf(pose).toRotationMatrix(), se3::translationOf(pose));
  if (!evaluated) {
    return false;
  }
  Eigen::Map<Eigen::VectorXd>(residuals, measurement_.rows) =
      evaluated->residual.head(measurement_.rows);
  if (jacobians != nullptr && jacobians[0] != nullptr) {
    using RowMajorJacobian = Eigen::Matrix<double, Eigen::Dynamic, se3::kPoseSize, Eigen::RowMajor>;
    Eigen::Map<RowMajorJacobian> by_pose(jacobians[0], measurement_.rows, se3::kPoseSize);
    by_pose.leftCols<6>() = evaluated->jacobian.topRows(measurement_.rows);
    by_pose.col(6).setZero();
  }
  return true;
}

std::unique_ptr<ceres::LossFunction> makeLoss(const WeightedPoint& point,
                                              const PoseRefinementOptions& options, bool robust) {
  std::unique_ptr<ceres::LossFunction> rho;  // none: rho(s) = s
  if (point.switchable) {
    rho = std::make_unique<SwitchLoss>(options.kappa);
  } else if (robust && options.loss == RobustLoss::kHuber) {
    rho = std::make_unique<ceres::HuberLoss>(point.measurement.rows == 3 ? options.huber_three_rows
                                                                         : options.huber_two_rows);
  }
  return std::make_unique<ceres::ScaledLoss>(rho.release(), point.weight * point.weight,
                                             ceres::TAKE_OWNERSHIP);
}

PoseOutcome solvePose(const std::vector<WeightedPoint>& points,
                      const std::vector<std::uint8_t>& active, const ProjectionModel& model,
                      const PoseRefinementOptions& options, bool robust,
                      const Eigen::Isometry3d& start) {
  se3::PoseVector pose = se3::toPoseVector(start);
  ceres::Problem problem;
  problem.AddParameterBlock(pose.data(), se3::kPoseSize, new se3::Manifold);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (active[i] != 0) {
      problem.AddResidualBlock(new PointCost(points[i].measurement, model),
                               makeLoss(points[i], options, robust).release(), pose.data());
    }
  }
  ceres::Solver::Summary summary;
  ceres::Solve(solverOptions(options), &problem, &summary);

  PoseOutcome solved;
  solved.pose = se3::toIsometry(pose);
  SolverOutcome& outcome = solved.outcome;
  outcome.initial_cost = 2.0 * summary.initial_cost;  // Ceres halves the sum, eq. 10 does not.
  outcome.final_cost = 2.0 * summary.final_cost;
  // The first entry is the evaluation at the start.
  outcome.iterations = std::max(0, static_cast<int>(summary.iterations.size()) - 1);
  // Ceres calls a start of infinite cost converged.
  outcome.usable = summary.IsSolutionUsable() && pose.allFinite() &&
                   std::isfinite(outcome.initial_cost) && std::isfinite(outcome.final_cost);
  outcome.converged = summary.termination_type == ceres::CONVERGENCE;
  solved.message = std::move(summary.message);
  return solved;
}

}  // namespace hmcdyn::detail

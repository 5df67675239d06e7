// SPDX-License-Identifier: BSD-3-Clause
#include "pose/solver.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <ceres/problem.h>
#include <ceres/solver.h>

namespace hmcdyn::detail {
namespace {

using RowMajor7x6 = Eigen::Matrix<double, kPoseSize, 6, Eigen::RowMajor>;
using RowMajor6x7 = Eigen::Matrix<double, 6, kPoseSize, Eigen::RowMajor>;

Eigen::Map<const Eigen::Quaterniond> rotationOf(const double* pose) {
  return Eigen::Map<const Eigen::Quaterniond>(pose);
}

Eigen::Map<const Eigen::Vector3d> translationOf(const double* pose) {
  return Eigen::Map<const Eigen::Vector3d>(pose + 4);
}

/// Unit quaternion of a rotation vector.
Eigen::Quaterniond exponential(const Eigen::Vector3d& omega) {
  const double s = 0.25 * omega.squaredNorm();  // of half the angle
  double cosine = 0.0;
  double quotient = 0.0;  // sin(half) / half
  if (s < 0.01) {
    // Nearly every step: the series, whose next term is below 3e-17.
    cosine = 1.0 - s / 2.0 * (1.0 - s / 12.0 * (1.0 - s / 30.0 * (1.0 - s / 56.0)));
    quotient = 1.0 - s / 6.0 * (1.0 - s / 20.0 * (1.0 - s / 42.0 * (1.0 - s / 72.0)));
  } else {
    const double half = std::sqrt(s);
    cosine = std::cos(half);
    quotient = std::sin(half) / half;
  }
  Eigen::Quaterniond q;
  q.w() = cosine;
  q.vec() = 0.5 * quotient * omega;
  return q;
}

Eigen::Matrix3d skew(const Eigen::Vector3d& a) {
  Eigen::Matrix3d m;
  m << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return m;
}

/// 2 dq/domega of Exp(omega) * q, rows x, y, z, w: for a unit quaternion its columns are
/// orthonormal.
Eigen::Matrix<double, 4, 3> leftProduct(const Eigen::Quaterniond& q) {
  Eigen::Matrix<double, 4, 3> m;
  m.topRows<3>() = q.w() * Eigen::Matrix3d::Identity() - skew(q.vec());
  m.row(3) = -q.vec().transpose();
  return m;
}

RowMajor7x6 plusJacobian(const double* x) {
  RowMajor7x6 jacobian = RowMajor7x6::Zero();
  jacobian.topLeftCorner<4, 3>() = 0.5 * leftProduct(rotationOf(x));
  jacobian.bottomLeftCorner<3, 3>() = -skew(translationOf(x));
  jacobian.bottomRightCorner<3, 3>().setIdentity();
  return jacobian;
}

/// Left inverse of plusJacobian().
RowMajor6x7 minusJacobian(const double* x) {
  const Eigen::Matrix<double, 3, 4> rotation = 2.0 * leftProduct(rotationOf(x)).transpose();
  RowMajor6x7 jacobian = RowMajor6x7::Zero();
  jacobian.topLeftCorner<3, 4>() = rotation;
  jacobian.bottomLeftCorner<3, 4>() = skew(translationOf(x)) * rotation;
  jacobian.bottomRightCorner<3, 3>().setIdentity();
  return jacobian;
}

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

PoseVector toPoseVector(const Eigen::Isometry3d& pose) {
  PoseVector vector;
  vector << Eigen::Quaterniond(pose.linear()).normalized().coeffs(), pose.translation();
  return vector;
}

Eigen::Isometry3d toIsometry(const PoseVector& pose) {
  Eigen::Isometry3d isometry = Eigen::Isometry3d::Identity();
  isometry.linear() = rotationOf(pose.data()).normalized().toRotationMatrix();
  isometry.translation() = translationOf(pose.data());
  return isometry;
}

PoseVector moved(const PoseVector& pose, const Eigen::Matrix<double, 6, 1>& delta) {
  const Eigen::Quaterniond step = exponential(delta.head<3>());
  PoseVector result;
  result.head<4>() = (step * rotationOf(pose.data())).normalized().coeffs();
  result.tail<3>() = step * translationOf(pose.data()) + delta.tail<3>();
  return result;
}

bool PoseManifold::Plus(const double* x, const double* delta, double* x_plus_delta) const {
  Eigen::Map<PoseVector>{x_plus_delta} =
      moved(Eigen::Map<const PoseVector>(x), Eigen::Map<const Eigen::Matrix<double, 6, 1>>(delta));
  return true;
}

#ifdef HMCDYN_CERES_HAS_MANIFOLD
bool PoseManifold::PlusJacobian(const double* x, double* jacobian) const {
  Eigen::Map<RowMajor7x6>{jacobian} = plusJacobian(x);
  return true;
}

bool PoseManifold::Minus(const double* y, const double* x, double* y_minus_x) const {
  const Eigen::Quaterniond step = rotationOf(y) * rotationOf(x).conjugate();
  const Eigen::AngleAxisd angle_axis(step.normalized());
  Eigen::Map<Eigen::Matrix<double, 6, 1>>(y_minus_x) << angle_axis.angle() * angle_axis.axis(),
      translationOf(y) - step * translationOf(x);
  return true;
}

bool PoseManifold::MinusJacobian(const double* x, double* jacobian) const {
  Eigen::Map<RowMajor6x7>{jacobian} = minusJacobian(x);
  return true;
}
#else
bool PoseManifold::ComputeJacobian(const double* x, double* jacobian) const {
  Eigen::Map<RowMajor7x6>{jacobian} = plusJacobian(x);
  return true;
}
#endif

PointCost::PointCost(const PointMeasurement& measurement, const ProjectionModel& model)
    : measurement_(measurement), model_(model) {
  set_num_residuals(measurement.rows);
  mutable_parameter_block_sizes()->push_back(kPoseSize);
}

bool PointCost::Evaluate(double const* const* parameters, double* residuals,
                         double** jacobians) const {
  const double* pose = parameters[0];
  const auto evaluated =
      pointResidual(measurement_, model_, rotationOf(pose).toRotationMatrix(), translationOf(pose));
  if (!evaluated) {
    return false;
  }
  Eigen::Map<Eigen::VectorXd>(residuals, measurement_.rows) =
      evaluated->residual.head(measurement_.rows);
  if (jacobians != nullptr && jacobians[0] != nullptr) {
    // Ceres asks for the derivative by the seven numbers and multiplies it by plusJacobian(): the
    // left inverse in between gives it back what pointResidual() knows.
    using RowMajorJacobian = Eigen::Matrix<double, Eigen::Dynamic, kPoseSize, Eigen::RowMajor>;
    Eigen::Map<RowMajorJacobian>(jacobians[0], measurement_.rows, kPoseSize) =
        evaluated->jacobian.topRows(measurement_.rows) * minusJacobian(pose);
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
  PoseVector pose = toPoseVector(start);
  ceres::Problem problem;
  problem.AddParameterBlock(pose.data(), kPoseSize, new PoseManifold);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (active[i] != 0) {
      problem.AddResidualBlock(new PointCost(points[i].measurement, model),
                               makeLoss(points[i], options, robust).release(), pose.data());
    }
  }
  ceres::Solver::Summary summary;
  ceres::Solve(solverOptions(options), &problem, &summary);

  PoseOutcome solved;
  solved.pose = toIsometry(pose);
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

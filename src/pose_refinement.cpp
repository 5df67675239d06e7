// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Eigenvalues>

#include <hmcdyn/pose_refinement.hpp>

#include "pose_refinement_input.hpp"
#include "pose_refinement_residual.hpp"
#include "pose_refinement_solver.hpp"

namespace hmcdyn {
namespace {

using detail::ProjectionModel;
using detail::WeightedPoint;
using Termination = PoseRefinementTermination;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Mask = std::vector<std::uint8_t>;  // one entry a WeightedPoint

constexpr std::size_t kFewestPoints = 3;

std::size_t count(const Mask& mask) {
  return static_cast<std::size_t>(std::count(mask.begin(), mask.end(), std::uint8_t{1}));
}

Mask inFront(const std::vector<WeightedPoint>& points, const ProjectionModel& model,
             const Eigen::Isometry3d& pose) {
  Mask mask;
  mask.reserve(points.size());
  for (const WeightedPoint& point : points) {
    mask.push_back(
        detail::pointResidual(point.measurement, model, pose.linear(), pose.translation()) ? 1 : 0);
  }
  return mask;
}

/// The 95 % test on the unweighted residual.
Mask inliersAt(const std::vector<WeightedPoint>& points, const ProjectionModel& model,
               const Eigen::Isometry3d& pose, const PoseRefinementOptions& options) {
  Mask mask;
  mask.reserve(points.size());
  for (const WeightedPoint& point : points) {
    const auto at_pose =
        detail::pointResidual(point.measurement, model, pose.linear(), pose.translation());
    const double limit =
        point.measurement.rows == 3 ? options.chi2_three_rows : options.chi2_two_rows;
    mask.push_back(at_pose && at_pose->residual.squaredNorm() <= limit ? 1 : 0);
  }
  return mask;
}

/// Gauss-Newton information of the last round at its optimum.
Matrix6d informationAt(const std::vector<WeightedPoint>& points, const Mask& active,
                       const ProjectionModel& model, const Eigen::Isometry3d& pose,
                       const PoseRefinementOptions& options, bool robust) {
  Matrix6d information = Matrix6d::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto at_pose = active[i] != 0 ? detail::pointResidual(points[i].measurement, model,
                                                                pose.linear(), pose.translation())
                                        : std::nullopt;
    if (at_pose) {
      std::array<double, 3> rho{};
      detail::makeLoss(points[i], options, robust)
          ->Evaluate(at_pose->residual.squaredNorm(), rho.data());
      information += rho[1] * at_pose->jacobian.transpose() * at_pose->jacobian;
    }
  }
  return information;
}

std::optional<Matrix6d> inverseOf(const Matrix6d& information) {
  const Eigen::Matrix<double, 6, 1> diagonal = information.diagonal();
  if (!information.allFinite() || !(diagonal.minCoeff() > 0.0)) {
    return std::nullopt;
  }
  // To a unit diagonal first: radians and metres have no common scale.
  const Eigen::Matrix<double, 6, 1> scale = diagonal.cwiseSqrt().cwiseInverse();
  const Matrix6d scaled = scale.asDiagonal() * information * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(scaled);
  constexpr double kSmallestRatio = 1e-12;
  if (eigen.info() != Eigen::Success ||
      !(eigen.eigenvalues()(0) > kSmallestRatio * eigen.eigenvalues()(5))) {
    return std::nullopt;
  }
  const Matrix6d inverse = eigen.eigenvectors() * eigen.eigenvalues().cwiseInverse().asDiagonal() *
                           eigen.eigenvectors().transpose();
  return scale.asDiagonal() * inverse * scale.asDiagonal();
}

/// The weights given, with lambda0 kappa / (kappa + |e|^2) for each switchable point: where eq. 10
/// with the prior has its minimum over lambda.
std::vector<float> refinedWeights(std::vector<float> weights,
                                  const std::vector<WeightedPoint>& points,
                                  const ProjectionModel& model, const Eigen::Isometry3d& pose,
                                  double kappa) {
  for (const WeightedPoint& point : points) {
    if (point.switchable) {
      const auto at_pose =
          detail::pointResidual(point.measurement, model, pose.linear(), pose.translation());
      weights[point.index] =
          at_pose
              ? static_cast<float>(point.weight * kappa / (kappa + at_pose->residual.squaredNorm()))
              : 0.0f;
    }
  }
  return weights;
}

/// The round to run next. Where nothing changed, the rounds up to the next loss would not either.
int nextRound(int round, bool settled, const PoseRefinementOptions& options) {
  const int first_plain_round = options.rounds - options.plain_rounds;
  if (!settled) {
    return round + 1;
  }
  return round < first_plain_round ? first_plain_round : options.rounds;
}

PoseRefinementResult stopped(PoseRefinementResult result, Termination why,
                             const std::string& account) {
  result.termination = why;
  result.message = std::string(toString(why)) + ": " + account;
  return result;
}

/// Runs the rounds from result.camera_from_world and completes the result.
PoseRefinementResult runRounds(const std::vector<WeightedPoint>& points, Mask active,
                               const ProjectionModel& model, const PoseRefinementOptions& options,
                               PoseRefinementResult result) {
  Eigen::Isometry3d pose = result.camera_from_world;
  int round = 0;
  while (true) {
    const bool robust = round < options.rounds - options.plain_rounds;
    const detail::SolverOutcome outcome =
        detail::solvePose(points, active, model, options, robust, pose);
    ++result.rounds;
    result.iterations += outcome.iterations;
    if (!outcome.usable) {
      return stopped(std::move(result), Termination::kNumericalFailure, outcome.message);
    }
    if (result.rounds == 1) {
      result.initial_cost = outcome.initial_cost;
    }
    pose = outcome.pose;
    Mask inliers = inliersAt(points, model, pose, options);
    if (count(inliers) < kFewestPoints) {
      const std::string account = std::to_string(count(inliers)) +
                                  " points agree with the pose of round " +
                                  std::to_string(result.rounds) + "; a pose takes 3";
      return stopped(std::move(result), Termination::kTooFewInliers, account);
    }
    round = nextRound(round, outcome.converged && inliers == active, options);
    if (round >= options.rounds) {
      result.camera_from_world = pose;
      result.covariance = inverseOf(informationAt(points, active, model, pose, options, robust));
      result.final_cost = outcome.final_cost;
      result.inliers = count(inliers);
      for (std::size_t i = 0; i < points.size(); ++i) {
        result.inlier[points[i].index] = inliers[i];
      }
      result.weight = refinedWeights(std::move(result.weight), points, model, pose, options.kappa);
      return stopped(std::move(result),
                     outcome.converged ? Termination::kConverged : Termination::kIterationLimit,
                     outcome.message);
    }
    active = std::move(inliers);
  }
}

}  // namespace

const char* toString(PoseRefinementTermination termination) noexcept {
  switch (termination) {
    case PoseRefinementTermination::kConverged:
      return "converged";
    case PoseRefinementTermination::kIterationLimit:
      return "iteration limit";
    case PoseRefinementTermination::kTooFewPoints:
      return "too few points";
    case PoseRefinementTermination::kTooFewInliers:
      return "too few inliers";
    case PoseRefinementTermination::kNumericalFailure:
      return "numerical failure";
  }
  return "invalid";
}

PoseRefinementResult refinePose(const PoseObservations& observations, const PinholeCamera& camera,
                                const Eigen::Isometry3d& initial,
                                const PoseRefinementOptions& options) {
  detail::checkInput(observations, camera, initial, options);
  const ProjectionModel model = detail::projectionModel(camera, options);
  const auto [points, not_finite] = detail::collectPoints(observations, options);

  PoseRefinementResult result;
  result.camera_from_world = initial;
  result.inlier.assign(observations.size(), 0);
  result.weight.assign(observations.weight.begin(), observations.weight.end());
  result.weight.resize(observations.size(), 1.0f);
  result.skipped_points = not_finite;

  Mask active = inFront(points, model, initial);
  result.usable_points = count(active);
  if (result.usable_points < kFewestPoints) {
    const std::string account =
        std::to_string(result.usable_points) +
        " points are finite, in front of the camera and of positive weight; a pose takes 3";
    return stopped(std::move(result), Termination::kTooFewPoints, account);
  }
  return runRounds(points, std::move(active), model, options, std::move(result));
}

}  // namespace hmcdyn

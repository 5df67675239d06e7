// SPDX-License-Identifier: BSD-3-Clause
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>

#include <hmcdyn/pose_refinement.hpp>

#include "pose/cholesky6.hpp"
#include "pose/collapsed.hpp"
#include "pose/input.hpp"
#include "pose/plain.hpp"
#include "pose/problem.hpp"

namespace hmcdyn {
namespace {

using Termination = PoseRefinementTermination;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

constexpr std::size_t kFewestPoints = 3;

std::optional<Matrix6d> inverseByEigenvalues(const Matrix6d& information) {
  // To a unit diagonal first: radians and metres have no common scale.
  const Vector6d scale = information.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(scale.asDiagonal() * information *
                                                      scale.asDiagonal());
  constexpr double kSmallestRatio = 1e-12;
  if (eigen.info() != Eigen::Success ||
      !(eigen.eigenvalues()(0) > kSmallestRatio * eigen.eigenvalues()(5))) {
    return std::nullopt;
  }
  const Matrix6d inverse = eigen.eigenvectors() * eigen.eigenvalues().cwiseInverse().asDiagonal() *
                           eigen.eigenvectors().transpose();
  return scale.asDiagonal() * inverse * scale.asDiagonal();
}

std::optional<Matrix6d> inverseOf(const Matrix6d& information) {
  const Vector6d diagonal = information.diagonal();
  if (!information.allFinite() || !(diagonal.minCoeff() > 0.0)) {
    return std::nullopt;
  }
  // The norms of a matrix, scaled to a unit diagonal, and of its inverse bound the ratio of its
  // eigenvalues: nearly always that settles it without them.
  detail::Cholesky6 cholesky;
  cholesky.compute(information);
  if (cholesky.pivotsExceed(0.0)) {
    const Matrix6d inverse = cholesky.inverse();
    const Vector6d inverse_diagonal = diagonal.cwiseInverse();
    const double square = inverse_diagonal.dot(information.cwiseAbs2() * inverse_diagonal);
    const double square_of_inverse = diagonal.dot(inverse.cwiseAbs2() * diagonal);
    if (square * square_of_inverse < 1e16) {
      return inverse;
    }
  }
  return inverseByEigenvalues(information);
}

/// The round to run next. Where nothing changed, the rounds up to the next loss would not either.
int nextRound(int round, bool settled, const PoseRefinementOptions& options) {
  const int first_plain_round = options.rounds - options.plain_rounds;
  if (!settled) {
    return round + 1;
  }
  return round < first_plain_round ? first_plain_round : options.rounds;
}

std::string messageOf(Termination why, std::string_view account) {
  std::string message;
  message.reserve(64);
  return message.append(toString(why)).append(": ").append(account);
}

PoseRefinementResult unrefined(const PoseObservations& observations, const Pose& initial) {
  PoseRefinementResult result;
  result.camera_from_world = initial;
  result.inlier.assign(observations.size(), 0);
  result.weight.assign(observations.weight.begin(), observations.weight.end());
  result.weight.resize(observations.size(), 1.0f);
  return result;
}

PoseRefinementResult runRounds(detail::PoseProblem& problem, const PoseObservations& observations,
                               const Pose& initial, const PoseRefinementOptions& options) {
  PoseRefinementResult result = unrefined(observations, initial);
  const auto stop = [&result](Termination why, std::string_view account) {
    result.termination = why;
    result.message = messageOf(why, account);
  };
  result.usable_points = problem.start(initial);
  result.skipped_points = problem.notFinite();
  if (result.usable_points < kFewestPoints) {
    stop(Termination::kTooFewPoints,
         std::to_string(result.usable_points) +
             " points are finite, in front of the camera and of positive weight; a pose takes 3");
    return result;
  }
  int round = 0;
  while (true) {
    const detail::SolverOutcome outcome =
        problem.solve(round < options.rounds - options.plain_rounds);
    ++result.rounds;
    result.iterations += outcome.iterations;
    if (!outcome.usable) {
      stop(Termination::kNumericalFailure, outcome.message);
      return result;
    }
    if (result.rounds == 1) {
      result.initial_cost = outcome.initial_cost;
    }
    const auto test = problem.testInliers();
    if (test.inliers < kFewestPoints) {
      stop(Termination::kTooFewInliers, std::to_string(test.inliers) +
                                            " points agree with the pose of round " +
                                            std::to_string(result.rounds) + "; a pose takes 3");
      return result;
    }
    round = nextRound(round, outcome.converged && test.are_the_active, options);
    if (round >= options.rounds) {
      result.camera_from_world = problem.pose();
      result.covariance = inverseOf(problem.information());
      result.final_cost = outcome.final_cost;
      result.inliers = test.inliers;
      problem.describePoints(result);
      stop(outcome.converged ? Termination::kConverged : Termination::kIterationLimit,
           outcome.message);
      return result;
    }
    problem.activateInliers();
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

PoseRefinementWorkspace::PoseRefinementWorkspace()
    : problem_(std::make_unique<detail::CollapsedPoseProblem>()) {}
PoseRefinementWorkspace::~PoseRefinementWorkspace() = default;
PoseRefinementWorkspace::PoseRefinementWorkspace(PoseRefinementWorkspace&&) noexcept = default;
PoseRefinementWorkspace& PoseRefinementWorkspace::operator=(PoseRefinementWorkspace&&) noexcept =
    default;

PoseRefinementResult refinePose(const PoseObservations& observations, const PinholeCamera& camera,
                                const Pose& initial, const PoseRefinementOptions& options,
                                PoseRefinementWorkspace& workspace) {
  detail::checkInput(observations, camera, initial, options);
  if (options.solver == PoseSolver::kCeresProblem) {
    detail::PlainPoseProblem problem(observations, camera, options);
    return runRounds(problem, observations, initial, options);
  }
  if (workspace.problem_ == nullptr) {  // moved from
    workspace.problem_ = std::make_unique<detail::CollapsedPoseProblem>();
  }
  workspace.problem_->assign(observations, camera, options);
  return runRounds(*workspace.problem_, observations, initial, options);
}

PoseRefinementResult refinePose(const PoseObservations& observations, const PinholeCamera& camera,
                                const Pose& initial, const PoseRefinementOptions& options) {
  PoseRefinementWorkspace workspace;
  return refinePose(observations, camera, initial, options, workspace);
}

}  // namespace hmcdyn

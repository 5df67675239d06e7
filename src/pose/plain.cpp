// SPDX-License-Identifier: BSD-3-Clause
#include "pose/plain.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "pose/input.hpp"

namespace hmcdyn::detail {
namespace {

std::size_t count(const std::vector<std::uint8_t>& mask) {
  return static_cast<std::size_t>(std::count(mask.begin(), mask.end(), std::uint8_t{1}));
}

}  // namespace

PlainPoseProblem::PlainPoseProblem(const PoseObservations& observations,
                                   const PinholeCamera& camera,
                                   const PoseRefinementOptions& options)
    : options_(options), model_(projectionModel(camera, options)) {
  CollectedPoints collected = collectPoints(observations, options);
  points_ = std::move(collected.points);
  not_finite_ = collected.not_finite;
}

std::size_t PlainPoseProblem::start(const Eigen::Isometry3d& pose) {
  pose_ = pose;
  active_.clear();
  for (const WeightedPoint& point : points_) {
    active_.push_back(
        pointResidual(point.measurement, model_, pose.linear(), pose.translation()) ? 1 : 0);
  }
  return count(active_);
}

SolverOutcome PlainPoseProblem::solve(bool robust) {
  robust_ = robust;
  PoseOutcome solved = solvePose(points_, active_, model_, options_, robust, pose_);
  if (solved.outcome.usable) {
    pose_ = solved.pose;
  }
  message_ = std::move(solved.message);
  solved.outcome.message = message_;
  return solved.outcome;
}

Eigen::Matrix<double, 6, 6> PlainPoseProblem::information() const {
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero();
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const auto at_pose = active_[i] != 0 ? pointResidual(points_[i].measurement, model_,
                                                         pose_.linear(), pose_.translation())
                                         : std::nullopt;
    if (at_pose) {
      std::array<double, 3> rho{};
      makeLoss(points_[i], options_, robust_)
          ->Evaluate(at_pose->residual.squaredNorm(), rho.data());
      information += rho[1] * at_pose->jacobian.transpose() * at_pose->jacobian;
    }
  }
  return information;
}

PoseProblem::InlierTest PlainPoseProblem::testInliers() {
  inlier_.clear();
  for (const WeightedPoint& point : points_) {
    const auto at_pose =
        pointResidual(point.measurement, model_, pose_.linear(), pose_.translation());
    const double limit =
        point.measurement.rows == 3 ? options_.chi2_three_rows : options_.chi2_two_rows;
    inlier_.push_back(at_pose && at_pose->residual.squaredNorm() <= limit ? 1 : 0);
  }
  return {count(inlier_), inlier_ == active_};
}

void PlainPoseProblem::describePoints(PoseRefinementResult& result) const {
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const WeightedPoint& point = points_[i];
    result.inlier[point.index] = inlier_[i];
    if (point.switchable) {
      const auto at_pose =
          pointResidual(point.measurement, model_, pose_.linear(), pose_.translation());
      const double s = at_pose ? at_pose->residual.squaredNorm() : 0.0;
      result.weight[point.index] =
          at_pose ? static_cast<float>(point.weight * options_.kappa / (options_.kappa + s)) : 0.0f;
    }
  }
}

}  // namespace hmcdyn::detail

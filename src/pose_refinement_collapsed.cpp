// SPDX-License-Identifier: BSD-3-Clause
#include "pose_refinement_collapsed.hpp"

#include <cmath>
#include <string>

#include "pose_refinement_descent.hpp"
#include "pose_refinement_input.hpp"

namespace hmcdyn::detail {

void CollapsedPoints::linearise(Linearisation& at, CollapseVariant variant) const {
  const Eigen::Isometry3d pose = toIsometry(at.pose);
  at.squared_residuals.resize(blocks.size() * kLanes);
  at.system = collapse(blocks, model, variant, pose.linear(), pose.translation(),
                       at.squared_residuals);
}

void CollapsedPoseProblem::assign(const PoseObservations& observations,
                                  const PinholeCamera& camera,
                                  const PoseRefinementOptions& options) {
  options_ = options;
  points_.model = projectionModel(camera, options);
  points_.blocks.clear();
  some_switchable_ = false;
  not_finite_ = 0;
  index_.clear();
  square_weight_.clear();
  limit_.clear();
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (!isFinite(observations, i)) {
      ++not_finite_;
      continue;
    }
    const double weight = observations.weight.empty() ? 1.0 : observations.weight[i];
    if (weight > 0.0) {
      addPoint(measurementOf(observations, i, options), weight,
               weight < 1.0 && options.weight_mode == WeightMode::kJoint);
      index_.push_back(i);
    }
  }
  active_.assign(index_.size(), 1);
  current_is_valid_ = false;
}

void CollapsedPoseProblem::addPoint(const PointMeasurement& measurement, double weight,
                                    bool switchable) {
  const std::size_t lane = square_weight_.size() % kLanes;
  if (lane == 0) {
    points_.blocks.emplace_back();
  }
  PointBlock& block = points_.blocks.back();
  const auto k = static_cast<Eigen::Index>(lane);
  const PinholeCamera& camera = points_.model.camera;
  const bool third_row = measurement.rows == 3;
  block.x[k] = measurement.world.x();
  block.y[k] = measurement.world.y();
  block.z[k] = measurement.world.z();
  block.u[k] = measurement.observed.x() - camera.cx;
  block.v[k] = measurement.observed.y() - camera.cy;
  block.information[k] = measurement.inverse_sigma.x() * measurement.inverse_sigma.x();
  block.weight[k] = weight * weight;
  block.huber[k] = third_row ? options_.huber_three_rows : options_.huber_two_rows;
  if (third_row) {
    block.third[k] = options_.depth_row == DepthRow::kDepth
                         ? measurement.observed.z()
                         : measurement.observed.z() - camera.cx;
    block.third_information[k] = measurement.inverse_sigma.z() * measurement.inverse_sigma.z();
  }
  if (switchable) {
    block.huber[k] = kNoHuber;
    block.inverse_kappa[k] = 1.0 / options_.kappa;
    some_switchable_ = true;
  }
  square_weight_.push_back(weight * weight);
  limit_.push_back(third_row ? options_.chi2_three_rows : options_.chi2_two_rows);
}

CollapseVariant CollapsedPoseProblem::variant(bool robust) const {
  return {options_.depth_row, robust && options_.loss == RobustLoss::kHuber, some_switchable_};
}

void CollapsedPoseProblem::setActive(std::size_t i, bool active) {
  active_[i] = active ? 1 : 0;
  points_.blocks[i / kLanes].weight[static_cast<Eigen::Index>(i % kLanes)] =
      active ? square_weight_[i] : 0.0;
}

std::size_t CollapsedPoseProblem::start(const Eigen::Isometry3d& pose) {
  // With the first round's losses, which then begins with this linearisation.
  current_.pose = toPoseVector(pose);
  current_variant_ = variant(options_.plain_rounds < options_.rounds);
  points_.linearise(current_, current_variant_);
  current_is_valid_ = true;
  std::size_t in_front = 0;
  for (std::size_t i = 0; i < index_.size(); ++i) {
    if (current_.squared_residuals[i] <= kBehindCamera) {
      ++in_front;
    } else {
      setActive(i, false);
      current_is_valid_ = false;
    }
  }
  return in_front;
}

SolverOutcome CollapsedPoseProblem::solve(bool robust) {
  if (!current_is_valid_ || !(current_variant_ == variant(robust))) {
    current_variant_ = variant(robust);
    points_.linearise(current_, current_variant_);
    current_is_valid_ = true;
  }
  SolverOutcome outcome;
  outcome.initial_cost = current_.system.cost;
  if (!std::isfinite(outcome.initial_cost)) {
    outcome.message = "the cost at the start is not finite";
    return outcome;
  }
  Descent descent;
  descent.points = &points_;
  descent.options = &options_;
  descent.variant = current_variant_;
  descent.current = &current_;
  descent.candidate = &candidate_;
  descend(descent);

  outcome.final_cost = current_.system.cost;
  outcome.iterations = descent.iterations;
  outcome.usable = current_.pose.allFinite();
  outcome.converged = descent.stop != nullptr;
  outcome.message = outcome.converged ? std::string(descent.stop) + " reached"
                                      : "max_iterations reached";
  return outcome;
}

PoseProblem::InlierTest CollapsedPoseProblem::testInliers() {
  inlier_.resize(index_.size());
  InlierTest test;
  std::size_t differences = 0;
  for (std::size_t i = 0; i < inlier_.size(); ++i) {
    inlier_[i] = current_.squared_residuals[i] <= limit_[i] ? 1 : 0;
    test.inliers += inlier_[i];
    differences += static_cast<std::size_t>(inlier_[i] ^ active_[i]);
  }
  test.are_the_active = differences == 0;
  return test;
}

void CollapsedPoseProblem::activateInliers() {
  for (std::size_t i = 0; i < inlier_.size(); ++i) {
    if (inlier_[i] != active_[i]) {
      setActive(i, inlier_[i] != 0);
      current_is_valid_ = false;
    }
  }
}

void CollapsedPoseProblem::describePoints(PoseRefinementResult& result) const {
  for (std::size_t i = 0; i < inlier_.size(); ++i) {
    result.inlier[index_[i]] = inlier_[i];
  }
  if (!some_switchable_) {
    return;
  }
  for (std::size_t i = 0; i < index_.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i % kLanes);
    const double inverse_kappa = points_.blocks[i / kLanes].inverse_kappa[k];
    if (inverse_kappa > 0.0) {
      const double weight = result.weight[index_[i]];
      result.weight[index_[i]] =
          static_cast<float>(weight / (1.0 + inverse_kappa * current_.squared_residuals[i]));
    }
  }
}

}  // namespace hmcdyn::detail

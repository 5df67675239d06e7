// SPDX-License-Identifier: BSD-3-Clause
#include "pose_refinement_collapsed.hpp"

#include <cmath>
#include <cstdint>
#include <string>

#include "pose_refinement_descent.hpp"
#include "pose_refinement_input.hpp"

namespace hmcdyn::detail {

namespace {

/// Not finite if one of a point's coordinates is not: 0 * infinity and 0 * NaN are NaN.
float zeroIfFinite(const PoseObservations& observations, std::size_t i) {
  return 0.0f * observations.x[i] + 0.0f * observations.y[i] + 0.0f * observations.z[i] +
         0.0f * observations.u[i] + 0.0f * observations.v[i];
}

/// Calls fill(block, place in the block, point) for every point.
template <class Fill>
void forEachPlace(std::vector<PointBlock>& blocks, std::size_t points, const Fill& fill) {
  for (std::size_t i = 0; i < points; ++i) {
    fill(blocks[i / kBlock], i % kBlock, i);
  }
}

}  // namespace

void CollapsedPoints::linearise(Linearisation& at, CollapseVariant variant) const {
  const Eigen::Isometry3d pose = toIsometry(at.pose);
  at.squared_residuals.resize(blocks.size() * kBlock);
  at.system = collapse(blocks, model, variant, pose.linear(), pose.translation(),
                       at.squared_residuals);
}

void CollapsedPoseProblem::assign(const PoseObservations& observations,
                                  const PinholeCamera& camera,
                                  const PoseRefinementOptions& options) {
  options_ = options;
  points_.model = projectionModel(camera, options);
  current_is_valid_ = false;
  choosePoints(observations);
  active_.assign(index_.size(), 1);
  fillBlocks(observations);
  if (options.depth_row != DepthRow::kNone) {
    fillThirdRow(observations);
  }
  some_switchable_ = false;
  if (options.weight_mode == WeightMode::kJoint) {
    fillSwitches(observations);
  }
}

void CollapsedPoseProblem::choosePoints(const PoseObservations& observations) {
  const bool weighted = !observations.weight.empty();
  index_.resize(observations.size());
  not_finite_ = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const bool finite = zeroIfFinite(observations, i) == 0.0f;
    const bool weightless = weighted && observations.weight[i] == 0.0f;
    index_[count] = static_cast<std::uint32_t>(i);
    count += static_cast<std::size_t>(finite && !weightless);
    not_finite_ += static_cast<std::size_t>(!finite);
  }
  index_.resize(count);
}

void CollapsedPoseProblem::fillBlocks(const PoseObservations& observations) {
  const std::size_t count = index_.size();
  points_.blocks.resize((count + kBlock - 1) / kBlock);
  if (count % kBlock != 0) {
    PointBlock& last = points_.blocks.back();
    last = PointBlock{};
    last.z.fill(1.0);
    last.huber.fill(1.0);
  }
  const double cx = points_.model.camera.cx;
  const double cy = points_.model.camera.cy;
  forEachPlace(points_.blocks, count, [&](PointBlock& block, std::size_t k, std::size_t j) {
    const std::size_t i = index_[j];
    block.x[k] = observations.x[i];
    block.y[k] = observations.y[i];
    block.z[k] = observations.z[i];
    block.u[k] = observations.u[i] - cx;
    block.v[k] = observations.v[i] - cy;
    block.information[k] = 1.0;
    block.weight[k] = 1.0;
    block.huber[k] = options_.huber_two_rows;
  });
  limit_.assign(count, options_.chi2_two_rows);
  square_weight_.assign(count, 1.0);
  if (!observations.sigma.empty()) {
    forEachPlace(points_.blocks, count, [&](PointBlock& block, std::size_t k, std::size_t j) {
      const double sigma = observations.sigma[index_[j]];
      block.information[k] = 1.0 / (sigma * sigma);
    });
  }
  if (!observations.weight.empty()) {
    forEachPlace(points_.blocks, count, [&](PointBlock& block, std::size_t k, std::size_t j) {
      const double weight = observations.weight[index_[j]];
      square_weight_[j] = weight * weight;
      block.weight[k] = weight * weight;
    });
  }
}

void CollapsedPoseProblem::fillThirdRow(const PoseObservations& observations) {
  forEachPlace(points_.blocks, index_.size(),
               [&](PointBlock& block, std::size_t k, std::size_t j) {
                 const PointMeasurement measurement =
                     measurementOf(observations, index_[j], options_);
                 const bool has_row = measurement.rows == 3;
                 const bool is_column = options_.depth_row == DepthRow::kDisparity;
                 block.third[k] =
                     measurement.observed.z() - (is_column ? points_.model.camera.cx : 0.0);
                 block.third_information[k] =
                     measurement.inverse_sigma.z() * measurement.inverse_sigma.z();
                 block.huber[k] = has_row ? options_.huber_three_rows : options_.huber_two_rows;
                 limit_[j] = has_row ? options_.chi2_three_rows : options_.chi2_two_rows;
               });
}

void CollapsedPoseProblem::fillSwitches(const PoseObservations& observations) {
  forEachPlace(points_.blocks, index_.size(),
               [&](PointBlock& block, std::size_t k, std::size_t j) {
                 const bool suspect =
                     !observations.weight.empty() && observations.weight[index_[j]] < 1.0f;
                 block.inverse_kappa[k] = suspect ? 1.0 / options_.kappa : 0.0;
                 block.huber[k] = suspect ? kNoHuber : block.huber[k];
                 some_switchable_ = some_switchable_ || suspect;
               });
}

CollapseVariant CollapsedPoseProblem::variant(bool robust) const {
  return {options_.depth_row, robust && options_.loss == RobustLoss::kHuber, some_switchable_};
}

void CollapsedPoseProblem::setActive(std::size_t i, bool active) {
  active_[i] = active ? 1 : 0;
  points_.blocks[i / kBlock].weight[i % kBlock] =
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
    const double inverse_kappa = points_.blocks[i / kBlock].inverse_kappa[i % kBlock];
    if (inverse_kappa > 0.0) {
      const double weight = result.weight[index_[i]];
      result.weight[index_[i]] =
          static_cast<float>(weight / (1.0 + inverse_kappa * current_.squared_residuals[i]));
    }
  }
}

}  // namespace hmcdyn::detail

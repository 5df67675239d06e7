// SPDX-License-Identifier: BSD-3-Clause
#include "pose/collapsed.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "pose/descent.hpp"
#include "pose/input.hpp"
#include "se3.hpp"

namespace hmcdyn::detail {

namespace {

/// Not finite if one of a point's coordinates is not: 0 * infinity and 0 * NaN are NaN.
float zeroIfFinite(const PoseObservations& observations, std::size_t i) {
  return 0.0f * observations.x[i] + 0.0f * observations.y[i] + 0.0f * observations.z[i] +
         0.0f * observations.u[i] + 0.0f * observations.v[i];
}

/// The places at the end that no point takes.
PointBlock unusedBlock() {
  PointBlock block;
  for (BlockField* field :
       {&block.x, &block.y, &block.u, &block.v, &block.information, &block.weight, &block.third,
        &block.third_information, &block.inverse_kappa}) {
    field->fill(0.0);
  }
  block.z.fill(1.0);
  block.huber.fill(1.0);
  return block;
}

}  // namespace

void CollapsedPoints::linearise(Linearisation& at, CollapseVariant variant) const {
  const Eigen::Map<const Eigen::Quaterniond> rotation(at.pose.data());  // a unit quaternion
  at.squared_residuals.resize(blocks.size() * kBlock);
  at.system = collapse(blocks, model, variant, rotation.toRotationMatrix(), at.pose.tail<3>(),
                       at.squared_residuals);
}

void CollapsedPoseProblem::assign(const PoseObservations& observations, const PinholeCamera& camera,
                                  const PoseRefinementOptions& options) {
  options_ = options;
  points_.model = projectionModel(camera, options);
  current_is_valid_ = false;
  choosePoints(observations);
  active_.assign(count_, 1);
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
  std::uint32_t not_finite = 0;
  std::uint32_t weightless = 0;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    not_finite += zeroIfFinite(observations, i) == 0.0f ? 0U : 1U;
  }
  for (const float weight : observations.weight) {
    weightless += weight == 0.0f ? 1U : 0U;
  }
  not_finite_ = not_finite;
  index_.clear();
  count_ = observations.size();
  if (not_finite + weightless == 0) {
    return;
  }
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (zeroIfFinite(observations, i) == 0.0f && !(weighted && observations.weight[i] == 0.0f)) {
      index_.push_back(static_cast<std::uint32_t>(i));
    }
  }
  count_ = index_.size();
}

template <class Value>
void CollapsedPoseProblem::fill(BlockField PointBlock::*field, const Value& value) {
  const std::size_t full = index_.empty() ? count_ / kBlock : 0;
  for (std::size_t b = 0; b < full; ++b) {
    BlockField& entries = points_.blocks[b].*field;
    for (std::size_t k = 0; k < kBlock; ++k) {
      entries[k] = value(b * kBlock + k);
    }
  }
  for (std::size_t j = full * kBlock; j < count_; ++j) {
    (points_.blocks[j / kBlock].*field)[j % kBlock] = value(indexOf(j));
  }
}

void CollapsedPoseProblem::fillBlocks(const PoseObservations& observations) {
  points_.blocks.resize((count_ + kBlock - 1) / kBlock);
  if (count_ % kBlock != 0) {
    points_.blocks.back() = unusedBlock();
  }
  const double cx = points_.model.camera.cx;
  const double cy = points_.model.camera.cy;
  fill(&PointBlock::x, [&](std::size_t i) -> double { return observations.x[i]; });
  fill(&PointBlock::y, [&](std::size_t i) -> double { return observations.y[i]; });
  fill(&PointBlock::z, [&](std::size_t i) -> double { return observations.z[i]; });
  fill(&PointBlock::u, [&](std::size_t i) { return observations.u[i] - cx; });
  fill(&PointBlock::v, [&](std::size_t i) { return observations.v[i] - cy; });
  fill(&PointBlock::huber, [&](std::size_t /*i*/) { return options_.huber_two_rows; });
  limit_.assign(count_, options_.chi2_two_rows);
  if (observations.sigma.empty()) {
    fill(&PointBlock::information, [](std::size_t /*i*/) { return 1.0; });
  } else {
    fill(&PointBlock::information, [&](std::size_t i) {
      const double sigma = observations.sigma[i];
      return 1.0 / (sigma * sigma);
    });
  }
  if (observations.weight.empty()) {
    fill(&PointBlock::weight, [](std::size_t /*i*/) { return 1.0; });
  } else {
    fill(&PointBlock::weight, [&](std::size_t i) {
      const double weight = observations.weight[i];
      return weight * weight;
    });
  }
  square_weight_.resize(points_.blocks.size() * kBlock);
  for (std::size_t b = 0; b < points_.blocks.size(); ++b) {
    std::copy(points_.blocks[b].weight.begin(), points_.blocks[b].weight.end(),
              square_weight_.begin() + static_cast<std::ptrdiff_t>(b * kBlock));
  }
}

void CollapsedPoseProblem::fillThirdRow(const PoseObservations& observations) {
  const double origin = options_.depth_row == DepthRow::kDisparity ? points_.model.camera.cx : 0.0;
  const auto has_row = [&](std::size_t i) { return hasDepth(observations.depth[i]); };
  fill(&PointBlock::third, [&](std::size_t i) {
    return measurementOf(observations, i, options_).observed.z() - origin;
  });
  fill(&PointBlock::third_information, [&](std::size_t i) {
    const double inverse_sigma = measurementOf(observations, i, options_).inverse_sigma.z();
    return inverse_sigma * inverse_sigma;
  });
  fill(&PointBlock::huber, [&](std::size_t i) {
    return has_row(i) ? options_.huber_three_rows : options_.huber_two_rows;
  });
  for (std::size_t j = 0; j < count_; ++j) {
    limit_[j] = has_row(indexOf(j)) ? options_.chi2_three_rows : options_.chi2_two_rows;
  }
}

void CollapsedPoseProblem::fillSwitches(const PoseObservations& observations) {
  for (std::size_t j = 0; j < count_; ++j) {
    const bool suspect = !observations.weight.empty() && observations.weight[indexOf(j)] < 1.0f;
    PointBlock& block = points_.blocks[j / kBlock];
    block.inverse_kappa[j % kBlock] = suspect ? 1.0 / options_.kappa : 0.0;
    if (suspect) {
      block.huber[j % kBlock] = kNoHuber;
      some_switchable_ = true;
    }
  }
}

CollapseVariant CollapsedPoseProblem::variant(bool robust) const {
  return {options_.depth_row, robust && options_.loss == RobustLoss::kHuber, some_switchable_};
}

void CollapsedPoseProblem::setActive(std::size_t i, bool active) {
  active_[i] = active ? 1 : 0;
  points_.blocks[i / kBlock].weight[i % kBlock] = active ? square_weight_[i] : 0.0;
}

std::size_t CollapsedPoseProblem::start(const Eigen::Isometry3d& pose) {
  // With the first round's losses, which then begins with this linearisation.
  current_.pose = se3::toPoseVector(pose);
  current_variant_ = variant(options_.plain_rounds < options_.rounds);
  points_.linearise(current_, current_variant_);
  current_is_valid_ = true;
  std::size_t behind = 0;
  for (std::size_t j = 0; j < count_; ++j) {
    behind += current_.squared_residuals[j] > kBehindCamera ? 1U : 0U;
  }
  for (std::size_t j = 0; j < count_ && behind > 0; ++j) {
    setActive(j, current_.squared_residuals[j] <= kBehindCamera);
    current_is_valid_ = false;
  }
  return count_ - behind;
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
  if (descent.current != &current_) {
    std::swap(current_, candidate_);
  }

  outcome.final_cost = current_.system.cost;
  outcome.iterations = descent.iterations;
  outcome.usable = current_.pose.allFinite();
  outcome.converged = descent.stop != nullptr;
  outcome.message = outcome.converged ? descent.stop : "max_iterations reached";
  return outcome;
}

PoseProblem::InlierTest CollapsedPoseProblem::testInliers() {
  inlier_.resize(count_);
  std::size_t inliers = 0;
  for (std::size_t j = 0; j < count_; ++j) {
    const bool inlier = current_.squared_residuals[j] <= limit_[j];
    inlier_[j] = inlier ? 1 : 0;
    inliers += inlier ? 1U : 0U;
  }
  return {inliers, inlier_ == active_};
}

void CollapsedPoseProblem::activateInliers() {
  for (std::size_t j = 0; j < count_; ++j) {
    if (inlier_[j] != active_[j]) {
      setActive(j, inlier_[j] != 0);
      current_is_valid_ = false;
    }
  }
}

void CollapsedPoseProblem::describePoints(PoseRefinementResult& result) const {
  if (index_.empty()) {
    std::copy(inlier_.begin(), inlier_.end(), result.inlier.begin());
  }
  for (std::size_t j = 0; j < index_.size(); ++j) {
    result.inlier[index_[j]] = inlier_[j];
  }
  for (std::size_t j = 0; j < count_ && some_switchable_; ++j) {
    const double inverse_kappa = points_.blocks[j / kBlock].inverse_kappa[j % kBlock];
    if (inverse_kappa > 0.0) {
      float& weight = result.weight[indexOf(j)];
      weight = static_cast<float>(weight / (1.0 + inverse_kappa * current_.squared_residuals[j]));
    }
  }
}

}  // namespace hmcdyn::detail

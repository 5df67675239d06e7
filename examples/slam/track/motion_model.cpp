// SPDX-License-Identifier: BSD-3-Clause
#include "slam/track/motion_model.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

#include <Eigen/Cholesky>

#include "se3.hpp"

namespace hmcdyn::slam {
namespace {

using se3::Vector6d;
using Matrix6 = MotionModel::Matrix6;

/// The same pose with a rotation that is one to the last digit: products lose some each time.
Eigen::Isometry3d normalized(const Eigen::Isometry3d& pose) {
  Eigen::Isometry3d result = pose;
  result.linear() = Eigen::Quaterniond(pose.linear()).normalized().toRotationMatrix();
  return result;
}

/// Nothing is known of a velocity: 10 rad/s, 10 m/s (s.d.).
Matrix6 unknownVelocity() { return 100.0 * Matrix6::Identity(); }

}  // namespace

void checkOptions(const MotionModelOptions& options) {
  const auto positive = [](const char* name, double value) {
    if (!(value > 0.0 && std::isfinite(value))) {
      throw std::invalid_argument(std::string("MotionModelOptions::") + name + " is " +
                                  std::to_string(value) + "; expected a finite value > 0");
    }
  };
  positive("acceleration_density", options.acceleration_density);
  positive("angular_density", options.angular_density);
  positive("max_gap", options.max_gap);
  positive("gate", options.gate);
}

MotionModel::MotionModel(const MotionModelOptions& options) : options_(options) {
  checkOptions(options);
}

bool MotionModel::inReach(double timestamp) const {
  const double gap = timestamp - state_->timestamp;
  return gap > 0.0 && gap <= options_.max_gap;
}

MotionModel::State MotionModel::predicted(double timestamp) const {
  const double dt = timestamp - state_->timestamp;
  const Eigen::Isometry3d motion = se3::motionOf(state_->velocity * dt);
  State next = *state_;
  next.timestamp = timestamp;
  next.camera_from_world = motion * state_->camera_from_world;

  Matrix12 transition = Matrix12::Identity();
  transition.topLeftCorner<6, 6>() = se3::adjoint(motion);
  transition.topRightCorner<6, 6>() = dt * Matrix6::Identity();
  Vector6d density;
  density << Eigen::Vector3d::Constant(options_.angular_density),
      Eigen::Vector3d::Constant(options_.acceleration_density);
  Matrix12 noise = Matrix12::Zero();
  noise.topLeftCorner<6, 6>().diagonal() = density * (dt * dt * dt / 3.0);
  noise.topRightCorner<6, 6>().diagonal() = density * (dt * dt / 2.0);
  noise.bottomLeftCorner<6, 6>().diagonal() = density * (dt * dt / 2.0);
  noise.bottomRightCorner<6, 6>().diagonal() = density * dt;
  next.covariance = transition * state_->covariance * transition.transpose() + noise;
  return next;
}

void MotionModel::begin(double timestamp, const Eigen::Isometry3d& camera_from_world,
                        const std::optional<Matrix6>& covariance) {
  if (!covariance) {
    state_.reset();
    return;
  }
  State state;
  state.timestamp = timestamp;
  state.camera_from_world = camera_from_world;
  state.covariance.topLeftCorner<6, 6>() = *covariance;
  state.covariance.bottomRightCorner<6, 6>() = unknownVelocity();
  state_ = state;
}

std::optional<MotionPrediction> MotionModel::predict(double timestamp) const {
  if (!state_) {
    return std::nullopt;
  }
  if (!inReach(timestamp)) {
    return MotionPrediction{state_->camera_from_world, std::nullopt};
  }
  const State next = predicted(timestamp);
  return MotionPrediction{next.camera_from_world, Matrix6(next.covariance.topLeftCorner<6, 6>())};
}

MotionModel::Update MotionModel::update(double timestamp,
                                        const Eigen::Isometry3d& camera_from_world,
                                        const std::optional<Matrix6>& covariance) {
  if (!state_ || !covariance || !inReach(timestamp)) {
    begin(timestamp, camera_from_world, covariance);
    return {camera_from_world, false};
  }
  State state = predicted(timestamp);
  const Vector6d innovation = se3::stepOf(camera_from_world * state.camera_from_world.inverse());
  const Matrix6 spread = state.covariance.topLeftCorner<6, 6>() + *covariance;
  const Eigen::LDLT<Matrix6> solver(spread);
  const double distance = innovation.dot(solver.solve(innovation));
  if (!(solver.info() == Eigen::Success && distance <= options_.gate)) {
    begin(timestamp, camera_from_world, covariance);
    return {camera_from_world, false};
  }
  const Eigen::Matrix<double, 6, 12> gain = solver.solve(state.covariance.topRows<6>());
  const Eigen::Matrix<double, 12, 1> step = gain.transpose() * innovation;
  state.camera_from_world = normalized(se3::motionOf(step.head<6>()) * state.camera_from_world);
  state.velocity += step.tail<6>();
  state.covariance -= gain.transpose() * state.covariance.topRows<6>();
  state.covariance = 0.5 * (state.covariance + state.covariance.transpose().eval());
  state_ = state;
  return {state.camera_from_world, true};
}

void MotionModel::relocate(const Eigen::Isometry3d& camera_from_world) {
  if (state_) {
    state_->camera_from_world = normalized(camera_from_world);
  }
}

void MotionModel::reset() { state_.reset(); }

}  // namespace hmcdyn::slam

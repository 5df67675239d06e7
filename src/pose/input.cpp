// SPDX-License-Identifier: BSD-3-Clause
#include "pose/input.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace hmcdyn::detail {
namespace {

// Names arrive as literals: a check that passes builds no string.

[[noreturn]] void refuse(const std::string& argument, const std::string& value,
                         const std::string& expected) {
  throw std::invalid_argument(argument + " is " + value + ", expected " + expected);
}

/// Also refuses a NaN and an infinity.
void checkRange(const char* argument, double value, bool in_range, const char* expected) {
  if (!std::isfinite(value) || !in_range) {
    refuse(argument, std::to_string(value), expected);
  }
}

void checkPositive(const char* argument, double value) {
  checkRange(argument, value, value > 0.0, "finite and > 0");
}

void checkNotNegative(const char* argument, double value) {
  checkRange(argument, value, value >= 0.0, "finite and >= 0");
}

void checkCount(const char* argument, int value, int least) {
  if (value < least) {
    refuse(argument, std::to_string(value), "at least " + std::to_string(least));
  }
}

/// Checks every element; `in_range` must be false for a NaN.
template <class InRange>
void checkElements(const char* array, Span<const float> values, const InRange& in_range,
                   const char* expected) {
  unsigned refused = 0;  // counted first: that the compiler can vectorise
  for (const float value : values) {
    refused += in_range(value) ? 0U : 1U;
  }
  for (std::size_t i = 0; i < values.size() && refused > 0; ++i) {
    if (!in_range(values[i])) {
      refuse(std::string("observations.") + array + "[" + std::to_string(i) + "]",
             std::to_string(values[i]), expected);
    }
  }
}

void checkSizes(const PoseObservations& observations, DepthRow depth_row) {
  const std::size_t n = observations.x.size();
  const auto check = [n](const char* array, Span<const float> values, bool may_be_empty) {
    if (values.size() != n && !(may_be_empty && values.empty())) {
      refuse(std::string("size of observations.") + array, std::to_string(values.size()),
             std::to_string(n) + ", the size of x" + (may_be_empty ? ", or 0" : ""));
    }
  };
  check("y", observations.y, false);
  check("z", observations.z, false);
  check("u", observations.u, false);
  check("v", observations.v, false);
  check("sigma", observations.sigma, true);
  check("depth", observations.depth, depth_row == DepthRow::kNone);
  check("weight", observations.weight, true);
  check("depth_sigma", observations.depth_sigma, true);
}

void checkCamera(const PinholeCamera& camera) {
  checkPositive("camera.fx", camera.fx);
  checkPositive("camera.fy", camera.fy);
  checkRange("camera.cx", camera.cx, true, "finite");
  checkRange("camera.cy", camera.cy, true, "finite");
}

void checkPose(const Eigen::Isometry3d& pose) {
  if (!pose.matrix().allFinite()) {
    refuse("initial", "not finite", "a rigid motion");
  }
  const Eigen::Matrix3d rotation = pose.linear();
  const double error = (rotation.transpose() * rotation - Eigen::Matrix3d::Identity()).norm();
  // Wide enough for a matrix that went through float and a chain of products.
  constexpr double kLargestError = 1e-3;
  if (error > kLargestError || rotation.determinant() < 0.0) {
    refuse("initial",
           "not a rigid motion (|R^T R - I| = " + std::to_string(error) +
               ", det R = " + std::to_string(rotation.determinant()) + ")",
           "a rotation and a translation");
  }
}

void checkOptions(const PoseRefinementOptions& options) {
  if (options.depth_row == DepthRow::kDepth) {
    checkModel(options.depth_error);
  }
  if (options.depth_row == DepthRow::kDisparity) {
    checkPositive("options.baseline_fx", options.baseline_fx);
  }
  if (options.loss == RobustLoss::kHuber) {
    checkPositive("options.huber_two_rows", options.huber_two_rows);
    checkPositive("options.huber_three_rows", options.huber_three_rows);
  }
  if (options.weight_mode == WeightMode::kJoint) {
    checkPositive("options.kappa", options.kappa);
  }
  checkCount("options.rounds", options.rounds, 1);
  checkCount("options.plain_rounds", options.plain_rounds, 0);
  if (options.plain_rounds > options.rounds) {
    refuse("options.plain_rounds", std::to_string(options.plain_rounds),
           "at most options.rounds, " + std::to_string(options.rounds));
  }
  checkPositive("options.chi2_two_rows", options.chi2_two_rows);
  checkPositive("options.chi2_three_rows", options.chi2_three_rows);
  checkNotNegative("options.min_depth", options.min_depth);
  checkCount("options.max_iterations", options.max_iterations, 1);
  checkNotNegative("options.function_tolerance", options.function_tolerance);
  checkNotNegative("options.gradient_tolerance", options.gradient_tolerance);
  checkNotNegative("options.parameter_tolerance", options.parameter_tolerance);
}

}  // namespace

void checkInput(const PoseObservations& observations, const PinholeCamera& camera,
                const Eigen::Isometry3d& initial, const PoseRefinementOptions& options) {
  checkSizes(observations, options.depth_row);
  checkCamera(camera);
  checkPose(initial);
  checkOptions(options);
  constexpr float kLargest = std::numeric_limits<float>::max();
  checkElements(
      "sigma", observations.sigma, [](float sigma) { return sigma > 0.0f && sigma <= kLargest; },
      "finite and > 0");
  checkElements(
      "depth_sigma", observations.depth_sigma,
      [](float sigma) { return sigma > 0.0f && sigma <= kLargest; }, "finite and > 0");
  checkElements(
      "weight", observations.weight,
      [](float weight) { return weight >= 0.0f && weight <= kLargest; }, "finite and >= 0");
}

ProjectionModel projectionModel(const PinholeCamera& camera, const PoseRefinementOptions& options) {
  // At min_depth = 0, too, a depth must leave the projection finite.
  constexpr double kSmallestDepth = 1e-12;
  return {camera, options.depth_row, options.baseline_fx,
          std::max(options.min_depth, kSmallestDepth)};
}

bool isFinite(const PoseObservations& observations, std::size_t i) {
  return std::isfinite(observations.x[i]) && std::isfinite(observations.y[i]) &&
         std::isfinite(observations.z[i]) && std::isfinite(observations.u[i]) &&
         std::isfinite(observations.v[i]);
}

PointMeasurement measurementOf(const PoseObservations& observations, std::size_t i,
                               const PoseRefinementOptions& options) {
  const double sigma = observations.sigma.empty() ? 1.0 : observations.sigma[i];
  PointMeasurement point;
  point.world =
      Eigen::Vector3f(observations.x[i], observations.y[i], observations.z[i]).cast<double>();
  point.observed << observations.u[i], observations.v[i], 0.0;
  point.inverse_sigma << 1.0 / sigma, 1.0 / sigma, 0.0;
  if (options.depth_row == DepthRow::kNone || !hasDepth(observations.depth[i])) {
    return point;
  }
  const double depth = observations.depth[i];
  point.rows = 3;
  if (options.depth_row == DepthRow::kDepth) {
    point.observed.z() = depth;
    point.inverse_sigma.z() =
        1.0 / (observations.depth_sigma.empty() ? depthError(depth, options.depth_error)
                                                : observations.depth_sigma[i]);
  } else {
    point.observed.z() = point.observed.x() - options.baseline_fx / depth;
    point.inverse_sigma.z() = 1.0 / sigma;
  }
  return point;
}

CollectedPoints collectPoints(const PoseObservations& observations,
                              const PoseRefinementOptions& options) {
  CollectedPoints collected;
  collected.points.reserve(observations.size());
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (!isFinite(observations, i)) {
      ++collected.not_finite;
      continue;
    }
    const double weight = observations.weight.empty() ? 1.0 : observations.weight[i];
    if (weight > 0.0) {
      const bool suspect = weight < 1.0;
      collected.points.push_back({i, weight, suspect && options.weight_mode == WeightMode::kJoint,
                                  measurementOf(observations, i, options)});
    }
  }
  return collected;
}

}  // namespace hmcdyn::detail

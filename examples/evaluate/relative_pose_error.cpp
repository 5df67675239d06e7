// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/relative_pose_error.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "evaluate/association.hpp"

namespace hmcdyn::evaluate {
namespace {

constexpr double kDegreesPerRadian = 180.0 / 3.14159265358979323846;

/// Rotation angle, 0..pi.
double angleOf(const Eigen::Isometry3d& pose) {
  return Eigen::Quaterniond::Identity().angularDistance(Eigen::Quaterniond(pose.linear()));
}

void checkOptions(const RpeOptions& options) {
  if (!(options.delta > 0.0) || !std::isfinite(options.delta)) {
    throw std::invalid_argument(
        fmt::format("relativePoseError: delta is {}; expected more than 0", options.delta));
  }
  if (options.delta_unit == DeltaUnit::kFrames && options.delta != std::floor(options.delta)) {
    throw std::invalid_argument(fmt::format(
        "relativePoseError: delta is {} frames; expected a whole number", options.delta));
  }
  if (!std::isfinite(options.offset)) {
    throw std::invalid_argument(
        fmt::format("relativePoseError: offset is {} s; expected a finite time", options.offset));
  }
  if (!(options.scale > 0.0) || !std::isfinite(options.scale)) {
    throw std::invalid_argument(
        fmt::format("relativePoseError: scale is {}; expected more than 0", options.scale));
  }
  if (options.tolerance && !(*options.tolerance >= 0.0)) {
    throw std::invalid_argument(fmt::format(
        "relativePoseError: tolerance is {} s; expected at least 0", *options.tolerance));
  }
}

/// Index of the value closest to `target` in a list that does not fall; the first of equals.
std::size_t closestIndex(const std::vector<double>& sorted, double target) {
  const auto above = std::lower_bound(sorted.begin(), sorted.end(), target);
  if (above == sorted.begin()) {
    return 0;
  }
  const double below = *std::prev(above);
  if (above != sorted.end() && *above - target < target - below) {
    return static_cast<std::size_t>(above - sorted.begin());
  }
  const auto first_below = std::lower_bound(sorted.begin(), above, below);
  return static_cast<std::size_t>(first_below - sorted.begin());
}

/// What a motion from one pose to the next adds to the distance along a trajectory.
double stepOf(const Eigen::Isometry3d& motion, DeltaUnit unit) {
  switch (unit) {
    case DeltaUnit::kMetres:
      return motion.translation().norm();
    case DeltaUnit::kRadians:
      return angleOf(motion);
    case DeltaUnit::kDegrees:
      return angleOf(motion) * kDegreesPerRadian;
    default:  // kFrames; kSeconds needs no steps
      return 1.0;
  }
}

/// How far along the trajectory each pose is, in the unit of delta.
std::vector<double> distancesAlong(const Trajectory& trajectory, DeltaUnit unit) {
  if (unit == DeltaUnit::kSeconds) {
    return timestampsOf(trajectory);
  }
  std::vector<double> distances{0.0};
  distances.reserve(trajectory.size());
  for (std::size_t i = 1; i < trajectory.size(); ++i) {
    const Eigen::Isometry3d motion = trajectory[i - 1].pose.inverse() * trajectory[i].pose;
    distances.push_back(distances.back() + stepOf(motion, unit));
  }
  return distances;
}

/// Pairs of poses of the estimate, delta apart.
std::vector<IndexPair> findPairs(const Trajectory& estimate, const RpeOptions& options) {
  const std::vector<double> distances = distancesAlong(estimate, options.delta_unit);
  std::vector<IndexPair> pairs;
  for (std::size_t i = 0; i < distances.size(); ++i) {
    const std::size_t j = closestIndex(distances, distances[i] + options.delta);
    if (j > i && j + 1 < distances.size()) {
      pairs.push_back({i, j});
    }
  }
  return pairs;
}

double defaultTolerance(const std::vector<double>& times) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < times.size(); ++i) {
    intervals.push_back(times[i] - times[i - 1]);
  }
  return intervals.empty() ? 0.0 : 2.0 * median(intervals);
}

/// Index of the ground truth nearest in time to each pose of the estimate; none beyond the
/// tolerance.
std::vector<std::optional<std::size_t>> findTruth(const Trajectory& groundtruth,
                                                  const Trajectory& estimate,
                                                  const RpeOptions& options) {
  const std::vector<double> times = timestampsOf(groundtruth);
  const double tolerance = options.tolerance.value_or(defaultTolerance(times));
  std::vector<std::optional<std::size_t>> truth;
  truth.reserve(estimate.size());
  for (const StampedPose& stamped : estimate) {
    const double time = stamped.timestamp + options.offset;
    const std::size_t nearest = closestIndex(times, time);
    const bool is_near = std::abs(times[nearest] - time) <= tolerance;
    truth.push_back(is_near ? std::optional<std::size_t>(nearest) : std::nullopt);
  }
  return truth;
}

Trajectory scaled(Trajectory trajectory, double scale) {
  for (StampedPose& stamped : trajectory) {
    stamped.pose.translation() *= scale;
  }
  return trajectory;
}

}  // namespace

const char* toString(DeltaUnit unit) noexcept {
  switch (unit) {
    case DeltaUnit::kSeconds:
      return "s";
    case DeltaUnit::kMetres:
      return "m";
    case DeltaUnit::kRadians:
      return "rad";
    case DeltaUnit::kDegrees:
      return "deg";
    case DeltaUnit::kFrames:
      return "frames";
  }
  return "invalid";
}

RpeResult relativePoseError(const Trajectory& groundtruth, const Trajectory& estimate,
                            const RpeOptions& options) {
  checkTrajectory(groundtruth, "groundtruth");
  checkTrajectory(estimate, "estimate");
  checkOptions(options);
  const Trajectory metric = scaled(estimate, options.scale);
  const auto truth = findTruth(groundtruth, metric, options);
  const std::vector<IndexPair> pairs = findPairs(metric, options);

  RpeResult result;
  for (const IndexPair& pair : pairs) {
    if (!truth[pair.first] || !truth[pair.second]) {
      continue;
    }
    const Eigen::Isometry3d true_motion =
        groundtruth[*truth[pair.second]].pose.inverse() * groundtruth[*truth[pair.first]].pose;
    const Eigen::Isometry3d motion = metric[pair.second].pose.inverse() * metric[pair.first].pose;
    const Eigen::Isometry3d error = motion.inverse() * true_motion;
    result.begin_timestamps.push_back(metric[pair.first].timestamp);
    result.end_timestamps.push_back(metric[pair.second].timestamp);
    result.translation_errors.push_back(error.translation().norm());
    result.rotation_errors.push_back(angleOf(error) * kDegreesPerRadian);
  }
  if (result.begin_timestamps.size() < 2) {
    throw std::runtime_error(fmt::format(
        "{} pairs of poses lie {} {} apart with ground truth at both ends; at least 2 are needed "
        "({} poses over {:.3f} s, {} pairs before the ground truth was looked up)",
        result.begin_timestamps.size(), options.delta, toString(options.delta_unit),
        estimate.size(), estimate.back().timestamp - estimate.front().timestamp, pairs.size()));
  }
  result.translation = computeStatistics(result.translation_errors);
  result.rotation = computeStatistics(result.rotation_errors);
  return result;
}

}  // namespace hmcdyn::evaluate

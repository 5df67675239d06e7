// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/pose_convention.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include <Eigen/Geometry>

namespace hmcdyn::evaluate {
namespace {

using Rotations = std::vector<Eigen::Quaterniond>;

Eigen::Quaterniond withWFirst(const Eigen::Quaterniond& q) {
  return {q.x(), q.y(), q.z(), q.w()};  // Eigen's constructor takes w, x, y, z
}

Eigen::Quaterniond inverted(const Eigen::Quaterniond& q) { return q.conjugate(); }

Rotations each(Rotations rotations, Eigen::Quaterniond (*convert)(const Eigen::Quaterniond&)) {
  std::transform(rotations.begin(), rotations.end(), rotations.begin(), convert);
  return rotations;
}

/// Median angle (rad) between how both turn from each pose to the one `step` later.
double disagreement(const Rotations& a, const Rotations& b, std::size_t step) {
  std::vector<double> angles;
  for (std::size_t i = 0; i + step < a.size(); ++i) {
    const Eigen::Quaterniond turn_a = a[i].conjugate() * a[i + step];
    const Eigen::Quaterniond turn_b = b[i].conjugate() * b[i + step];
    angles.push_back(turn_a.angularDistance(turn_b));
  }
  const auto middle = angles.begin() + static_cast<std::ptrdiff_t>(angles.size() / 2);
  std::nth_element(angles.begin(), middle, angles.end());
  return *middle;
}

/// Root mean square distance of the positions from their mean (m).
double reach(const std::vector<Eigen::Vector3d>& positions) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& position : positions) {
    mean += position / static_cast<double>(positions.size());
  }
  double square = 0.0;
  for (const Eigen::Vector3d& position : positions) {
    square += (position - mean).squaredNorm() / static_cast<double>(positions.size());
  }
  return std::sqrt(square);
}

/// Trackers are wrong by per cent; the scale of those that cannot know it is about 1 or arbitrary.
std::string otherLength(double reach_of_truth, double reach_of_estimate) {
  constexpr double kThousand = 1000.0;
  constexpr double kNear = 1.2;
  const auto is_thousand = [](double ratio) {
    return ratio > kThousand / kNear && ratio < kThousand * kNear;
  };
  constexpr double kStill = 0.01;  // m
  if (reach_of_truth > kStill && is_thousand(reach_of_estimate / reach_of_truth)) {
    return "the estimate's positions look like millimetres; expected metres";
  }
  if (reach_of_estimate > kStill && is_thousand(reach_of_truth / reach_of_estimate)) {
    return "the ground truth's positions look like millimetres; expected metres";
  }
  return {};
}

}  // namespace

std::string otherConvention(const Trajectory& groundtruth, const Trajectory& estimate,
                            const AssociationOptions& options) {
  Rotations truth;
  Rotations found;
  std::vector<Eigen::Vector3d> positions_of_truth;
  std::vector<Eigen::Vector3d> positions_found;
  for (const IndexPair& pair :
       associate(timestampsOf(groundtruth), timestampsOf(estimate), options)) {
    truth.emplace_back(groundtruth[pair.first].pose.linear());
    found.emplace_back(estimate[pair.second].pose.linear());
    positions_of_truth.emplace_back(groundtruth[pair.first].pose.translation());
    positions_found.emplace_back(estimate[pair.second].pose.translation());
  }
  constexpr std::size_t kLeast = 10;  // poses
  if (truth.size() < kLeast) {
    return {};
  }
  std::string length = otherLength(reach(positions_of_truth), reach(positions_found));
  if (!length.empty()) {
    return length;
  }
  const std::size_t step = truth.size() / 4;  // enough to have turned
  const double as_read = disagreement(truth, found, step);
  constexpr double kWrong = 0.05;     // rad; trackers err by less over a quarter of a recording
  constexpr double kExplained = 0.2;  // of the disagreement is left
  struct Other {
    double disagreement;
    const char* what;
  };
  const std::array<Other, 4> others{{
      {disagreement(truth, each(found, withWFirst), step),
       "the estimate's quaternions look as if w came first; expected qx qy qz qw"},
      {disagreement(each(truth, withWFirst), found, step),
       "the ground truth's quaternions look as if w came first; expected qx qy qz qw"},
      {disagreement(truth, each(found, inverted), step),
       "the estimate's poses look inverted, the world's in the camera; expected the camera's in "
       "the world"},
      {disagreement(each(truth, inverted), found, step),
       "the ground truth's poses look inverted, the world's in the camera; expected the camera's "
       "in the world"},
  }};
  const Other best = *std::min_element(
      others.begin(), others.end(),
      [](const Other& a, const Other& b) { return a.disagreement < b.disagreement; });
  return as_read > kWrong && best.disagreement < kExplained * as_read ? best.what : "";
}

}  // namespace hmcdyn::evaluate

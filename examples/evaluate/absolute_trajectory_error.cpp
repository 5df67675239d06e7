// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/absolute_trajectory_error.hpp"

#include <stdexcept>

#include <fmt/format.h>

namespace hmcdyn::evaluate {

AteResult absoluteTrajectoryError(const Trajectory& groundtruth, const Trajectory& estimate,
                                  const AteOptions& options) {
  checkTrajectory(groundtruth, "groundtruth");
  checkTrajectory(estimate, "estimate");
  const std::vector<IndexPair> pairs =
      associate(timestampsOf(groundtruth), timestampsOf(estimate), options.association);
  if (pairs.size() < 3) {
    throw std::runtime_error(fmt::format(
        "{} of {} poses lie within {} s of a ground-truth pose; at least 3 are needed (estimate "
        "{:.3f} to {:.3f} s, ground truth {:.3f} to {:.3f} s, offset {} s{})",
        pairs.size(), estimate.size(), options.association.tolerance, estimate.front().timestamp,
        estimate.back().timestamp, groundtruth.front().timestamp, groundtruth.back().timestamp,
        options.association.offset,
        pairs.empty() ? fmt::format("; if both began together, the offset is {:.3f} s",
                                    groundtruth.front().timestamp - estimate.front().timestamp)
                      : ""));
  }

  AteResult result;
  for (const IndexPair& pair : pairs) {
    result.timestamps.push_back(estimate[pair.second].timestamp);
    result.estimated.emplace_back(estimate[pair.second].pose.translation());
    result.groundtruth.emplace_back(groundtruth[pair.first].pose.translation());
  }
  result.alignment = align(result.estimated, result.groundtruth, options.alignment);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    result.estimated[i] = result.alignment * result.estimated[i];
    result.errors.push_back((result.estimated[i] - result.groundtruth[i]).norm());
  }
  result.error = computeStatistics(result.errors);
  return result;
}

}  // namespace hmcdyn::evaluate

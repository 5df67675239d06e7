// SPDX-License-Identifier: BSD-3-Clause
// From the caller's arrays to the points that may take part.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Geometry>

#include <hmcdyn/pose_refinement.hpp>

#include "pose/solver.hpp"

namespace hmcdyn::detail {

/// @throws std::invalid_argument as refinePose() documents.
void checkInput(const PoseObservations& observations, const PinholeCamera& camera,
                const Eigen::Isometry3d& initial, const PoseRefinementOptions& options);

ProjectionModel projectionModel(const PinholeCamera& camera, const PoseRefinementOptions& options);

/// Whether all of a point's coordinates are finite.
bool isFinite(const PoseObservations& observations, std::size_t i);

PointMeasurement measurementOf(const PoseObservations& observations, std::size_t i,
                               const PoseRefinementOptions& options);

struct CollectedPoints {
  std::vector<WeightedPoint> points;  ///< Finite, weight > 0, in the caller's order.
  std::size_t not_finite = 0;         ///< Left out for a NaN or infinite coordinate.
};

CollectedPoints collectPoints(const PoseObservations& observations,
                              const PoseRefinementOptions& options);

}  // namespace hmcdyn::detail

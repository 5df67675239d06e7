// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <hmcdyn/span.hpp>

namespace hmcdyn::evaluate {

/// What an alignment may change.
enum class AlignmentModel {
  kRigid,       ///< SE(3): rotation and translation.
  kSimilarity,  ///< Sim(3): rotation, translation and scale, for trajectories without a scale.
};

/// Maps a point p to scale * rotation * p + translation.
struct Alignment {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();  ///< m.
  double scale = 1.0;                                     ///< 1 for kRigid.
  /// False when the points lie on a line or coincide, so that other rotations fit equally well.
  /// The distance of each aligned point to its target is the same for all of them.
  bool unique = true;

  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const {
    return scale * (rotation * point) + translation;
  }
};

/// The alignment of `source` to `target` (m, paired by index) with the least sum of squared
/// distances, in closed form (Umeyama 1991, "Least-squares estimation of transformation parameters
/// between two point patterns").
/// @throws std::invalid_argument when the sizes differ or a coordinate is not finite.
/// @throws std::runtime_error when there are fewer than 3 pairs, or when a scale is asked for and
/// not defined because the points of one side coincide or the sides are not related at all.
Alignment align(Span<const Eigen::Vector3d> source, Span<const Eigen::Vector3d> target,
                AlignmentModel model = AlignmentModel::kRigid);

}  // namespace hmcdyn::evaluate

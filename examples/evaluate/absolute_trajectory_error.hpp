// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Core>

#include "evaluate/alignment.hpp"
#include "evaluate/association.hpp"
#include "evaluate/statistics.hpp"
#include "evaluate/trajectory.hpp"

namespace hmcdyn::evaluate {

struct AteOptions {
  AssociationOptions association;                     ///< Ground truth first, estimate second.
  AlignmentModel alignment = AlignmentModel::kRigid;  ///< kSimilarity also fits a scale.
};

/// The lists have an element a pair, in order of time.
struct AteResult {
  Statistics error;                          ///< Distances after alignment (m).
  Alignment alignment;                       ///< From the estimate's world to the truth's.
  std::vector<double> timestamps;            ///< Of the estimate (s), without the offset.
  std::vector<double> errors;                ///< Distance of estimate and truth (m).
  std::vector<Eigen::Vector3d> estimated;    ///< Positions of the estimate, aligned (m).
  std::vector<Eigen::Vector3d> groundtruth;  ///< Positions of the truth (m).
};

/// Absolute trajectory error (ATE): distances between the positions of an estimate and the ground
/// truth over all frames that can be associated, after the alignment that makes their mean square
/// least (Sturm et al. 2012, "A benchmark for the evaluation of RGB-D SLAM systems"). With its
/// defaults it gives the results of TUM's evaluate_ate.py.
/// @throws std::invalid_argument as associate() and checkTrajectory() do.
/// @throws std::runtime_error when fewer than 3 poses can be associated, and as align() does.
AteResult absoluteTrajectoryError(const Trajectory& groundtruth, const Trajectory& estimate,
                                  const AteOptions& options = {});

}  // namespace hmcdyn::evaluate

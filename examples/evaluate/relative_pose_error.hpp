// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "evaluate/statistics.hpp"
#include "evaluate/trajectory.hpp"

namespace hmcdyn::evaluate {

/// What the distance between the two poses of a pair is measured in.
enum class DeltaUnit {
  kSeconds,  ///< Time.
  kMetres,   ///< Length of the estimate's path.
  kRadians,  ///< Sum of the angles turned from pose to pose of the estimate.
  kDegrees,  ///< The same in degrees.
  kFrames,   ///< Poses of the estimate; delta must be a whole number.
};

/// "s", "m", "rad", "deg" or "frames".
const char* toString(DeltaUnit unit) noexcept;

struct RpeOptions {
  double delta = 1.0;                          ///< Distance between the poses of a pair, > 0.
  DeltaUnit delta_unit = DeltaUnit::kSeconds;  ///< Unit of delta.
  double offset = 0.0;                         ///< Added to the time stamps of the estimate (s).
  double scale = 1.0;                          ///< The estimate's positions are multiplied by it.
  /// Largest time difference of an estimated pose and its ground truth (s), itself included. Not
  /// set: twice the median interval of the ground truth, as in TUM's tool.
  std::optional<double> tolerance;
};

/// The lists have an element a pair, in order of time.
struct RpeResult {
  Statistics translation;                  ///< m per delta.
  Statistics rotation;                     ///< Degrees per delta.
  std::vector<double> begin_timestamps;    ///< Of the pair's first pose in the estimate (s).
  std::vector<double> end_timestamps;      ///< Of its second pose (s).
  std::vector<double> translation_errors;  ///< m.
  std::vector<double> rotation_errors;     ///< Degrees, 0..180.
};

/// Relative pose error (RPE): how far the motion of the estimate from each pose to the one a fixed
/// delta later differs from the ground truth's motion over the same time (Sturm et al. 2012, "A
/// benchmark for the evaluation of RGB-D SLAM systems"). Gives the results of TUM's
/// evaluate_rpe.py with --fixed_delta:
///   - the second pose of a pair is the one whose distance is closest to delta (the earlier of two
///     equally close ones); a pair that would end with the very last pose is left out;
///   - each pose is compared with the ground-truth pose nearest in time, and a pair is left out
///     where that is farther than the tolerance; a ground-truth pose may serve several pairs.
/// It differs from that tool in three points: all pairs are used (the tool draws 10000 at random
/// when there are more), a pose is never paired with itself (the tool does so before a gap of more
/// than twice delta), and for kMetres the path is measured after scaling.
/// @throws std::invalid_argument as checkTrajectory() does, or when an option is out of range.
/// @throws std::runtime_error when fewer than 2 pairs are left.
RpeResult relativePoseError(const Trajectory& groundtruth, const Trajectory& estimate,
                            const RpeOptions& options = {});

}  // namespace hmcdyn::evaluate

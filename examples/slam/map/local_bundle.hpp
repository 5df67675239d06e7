// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "slam/map/bundle_adjustment.hpp"
#include "slam/map/map.hpp"

namespace hmcdyn::slam {

struct LocalBundleOptions {
  std::size_t free_key_frames = 8;    ///< The latest key frame and those that share most with it.
  std::size_t fixed_key_frames = 12;  ///< Others that see the same points and hold them in place.
  std::size_t min_observations = 2;   ///< Points that fewer key frames see stay where they are.
};

/// A part of the map to be optimised beside it, and what its indices mean.
struct LocalBundle {
  BundleProblem problem;
  std::vector<int> key_frames;  ///< Key frame of each pose.
  std::vector<int> points;      ///< Map point of each point.
};

/// The latest key frame, its neighbours, and the points they see that are believed to stand still;
/// without a pose where there are not two key frames yet.
LocalBundle makeLocalBundle(const Map& map, const LocalBundleOptions& options = {});

/// Whether the solution tells inliers from outliers: one that failed, or was stopped before its
/// first round, calls nothing an inlier, and would empty the map.
bool judgesObservations(const BundleSolution& solution);

/// What the solution means for the map. Observations of weight 0 took no part and stay.
MapCorrection toCorrection(const LocalBundle& bundle, const BundleSolution& solution);

}  // namespace hmcdyn::slam

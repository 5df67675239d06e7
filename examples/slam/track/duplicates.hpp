// SPDX-License-Identifier: BSD-3-Clause
// Map points that are one: a key frame sees a place again that the map knows already.
#pragma once

#include <utility>
#include <vector>

#include "slam/features/frame.hpp"
#include "slam/map/map.hpp"
#include "slam/track/matcher.hpp"

namespace hmcdyn::slam {

struct DuplicateOptions {
  /// A key frame looks for points at its place that none of so many key frames before it saw: the
  /// local map has lost them, and they would be made again at each visit, without end.
  int forgotten_after = 20;
  std::size_t neighbours = 8;  ///< Key frames that a new one is compared with.
  float radius = 4.0f;         ///< Search window around a projection at the finest level (px).
  MatcherOptions matcher;
};

/// Ties key points without a map point to forgotten points at their place.
void tieToForgottenPoints(Frame& frame, const KeyPointGrid& grid, const Map& map,
                          const DuplicateOptions& options);

/// What the latest key frame and its neighbours know of each other's points.
struct KnownPoints {
  struct Sighting {
    int point = kNoMapPoint;
    int key_frame = 0;
    std::size_t key_point = 0;
  };
  std::vector<std::pair<int, int>> duplicates;  ///< A point, and the one that it is.
  std::vector<Sighting> sightings;              ///< Key points that see a point, unknown so far.
};

/// Looks for the neighbours' points in the latest key frame and for its points in them. A point
/// that projects onto a key point, looks like it and lies at its depth is seen there; where the key
/// point has a point already, both are one, and the one with more observations stays.
KnownPoints knownPointsOf(const Map& map, const DuplicateOptions& options);

}  // namespace hmcdyn::slam

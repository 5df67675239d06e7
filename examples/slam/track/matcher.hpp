// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include <hmcdyn/types.hpp>

#include "slam/features/frame.hpp"
#include "slam/map/map.hpp"

namespace hmcdyn::slam {

/// Which key points may be matched.
enum class MatchPolicy : std::uint8_t {
  kKeptPoints,  ///< Those that the filter keeps.
  /// All, where they look like a point that the map trusts to stand still and are where it should
  /// be: for frames in which the filter leaves too few.
  kTrustedPoints,
};

struct MatcherOptions {
  int max_distance = 70;      ///< Descriptors farther apart do not match (bits of 256).
  float max_ratio = 0.9f;     ///< Best to second best distance on the same pyramid level.
  float scale_factor = 1.2f;  ///< Of the feature pyramid.
  int levels = 8;             ///< Of the feature pyramid.
  /// A key point's depth may differ from the map point's by this share.
  float max_depth_difference = 0.15f;
};

/// Key points of a frame by place, for window searches.
class KeyPointGrid {
 public:
  explicit KeyPointGrid(const Frame& frame);

  /// Key points within `radius` (px, square window) of a pixel, in the order of their numbers
  /// within a cell, cells by row.
  std::vector<std::size_t> within(float u, float v, float radius) const;

 private:
  static constexpr float kCell = 16.0f;  // px
  int columns_;
  int rows_;
  std::vector<std::vector<std::size_t>> cells_;
  const Frame* frame_;
};

/// A map point and the key point that was matched with it.
struct PointMatch {
  int map_point = kNoMapPoint;
  std::size_t key_point = 0;
  int distance = 0;  ///< Of the descriptors (bits).
};

struct ProjectionSearch {
  std::vector<PointMatch> matches;  ///< One-to-one, by key point.
  std::vector<int> visible;         ///< Map points that project into the image.
  std::vector<int> seen_dynamic;    ///< Those whose best key point has weight 0: not matched.
};

/// Matches map points with the frame's key points near their projection at a pose. Key points of
/// weight 0 compete, so that a point on a moving thing is not matched with its static neighbour,
/// but are matched by MatchPolicy::kTrustedPoints only.
/// @param radius of the search window at the finest level (px); grows with the level.
ProjectionSearch matchByProjection(const Frame& frame, const KeyPointGrid& grid, const Map& map,
                                   const std::vector<int>& candidates,
                                   const Eigen::Isometry3d& camera_from_world,
                                   const PinholeCamera& camera, float radius,
                                   const MatcherOptions& options,
                                   MatchPolicy policy = MatchPolicy::kKeptPoints);

/// Matches the map points of a key frame with a frame's key points by descriptor alone, mutually
/// best, for when there is no pose to search around.
std::vector<PointMatch> matchByDescriptor(const Frame& frame, const KeyFrame& key_frame,
                                          const MatcherOptions& options);

}  // namespace hmcdyn::slam

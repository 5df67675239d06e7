// SPDX-License-Identifier: BSD-3-Clause
// What a frame's matches with the map say to the pose refinement.
#pragma once

#include <vector>

#include <Eigen/Geometry>

#include <hmcdyn/pose_refinement.hpp>

#include "slam/features/frame.hpp"
#include "slam/map/map.hpp"
#include "slam/track/matcher.hpp"

namespace hmcdyn::slam {

/// The matched points as arrays: depths without the systematic error of their points, each with its
/// standard deviation.
class MatchedPoints {
 public:
  /// @param policy kTrustedPoints: every match has the weight 1, whatever the filter says.
  MatchedPoints(const Frame& frame, const std::vector<PointMatch>& matches, const Map& map,
                MatchPolicy policy);

  PoseObservations view() const {
    return {x_, y_, z_, u_, v_, sigma_, depth_, weight_, depth_sigma_};
  }

  /// Outliers whose pixel agrees with a pose lose their depth: most of what fails on a real camera
  /// fails by depth alone, and such a point is as good as one without a depth.
  /// @return whether there were any.
  bool dropDisagreeingDepths(const PoseRefinementResult& refined, const PinholeCamera& camera,
                             const PoseRefinementOptions& options);

 private:
  std::vector<float> x_, y_, z_, u_, v_, sigma_, depth_, weight_, depth_sigma_;
};

/// By how much a frame's pixels are noisier than its sigmas say, 0.6..2: blur and the camera differ
/// from frame to frame, and fixed thresholds fit one of them. From the median residual of the
/// matches at a pose. 1 without a match.
double noiseFactor(const Frame& frame, const std::vector<PointMatch>& matches,
                   const Eigen::Isometry3d& camera_from_world, const Map& map);

}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <hmcdyn/pose_refinement.hpp>
#include <hmcdyn/types.hpp>

#include "slam/loop/descriptor_matcher.hpp"
#include "slam/loop/loop_key_frame.hpp"
#include "slam/loop/rigid_ransac.hpp"

namespace hmcdyn::slam {

/// What became of a loop candidate.
enum class LoopVerdict : std::uint8_t {
  kAccepted,
  kLowScore,        ///< Looks less alike than key frames that do see the same.
  kInconsistent,    ///< The key frames before did not point there.
  kTooFewMatches,   ///< Too few key points look alike.
  kTooFewInliers,   ///< Too few of them agree with one motion.
  kClustered,       ///< They lie too close together in an image.
  kLittleSupport,   ///< Too many points that should be seen again are not.
  kLocalSupport,    ///< What is seen again lies together: a thing that is in both, not the place.
  kDepthDisagrees,  ///< What is seen where they should be has another depth.
  kOutvoted,        ///< Good, but another candidate of the same key frame is better.
};

/// "accepted", "low score", "inconsistent", ...
const char* toString(LoopVerdict verdict) noexcept;

struct LoopVerificationOptions {
  DescriptorMatcherOptions matcher;
  RigidRansacOptions ransac;
  std::size_t min_matches = 20;
  std::size_t min_inliers = 30;  ///< After the search around the motion.
  float radius = 8.0f;           ///< Of that search (px, > 0).
  int max_distance = 80;         ///< Of its descriptors (bits of 256).
  float cell = 80.0f;            ///< Side of the squares that measure the spread (px, > 0).
  std::size_t min_cells = 8;     ///< Squares with an inlier, in either image.
  double min_support = 0.15;     ///< Of the points that should be seen again this share must be.
  /// And in this share of the squares of side `cell` which hold at least `cell_points` of them, a
  /// share of `min_square_support` must be; a poster that hangs in two rooms brings its own
  /// squares only, however many points it has.
  double min_coverage = 0.5;
  std::size_t cell_points = 3;  ///< >= 1
  double min_square_support = 0.1;
  /// Of the points with a key point within `neighbour_radius` of where they should be, this share
  /// must have its depth, within 3 sigma and `depth_tolerance` of it.
  double min_depth_agreement = 0.6;
  float neighbour_radius = 12.0f;  ///< px, > 0
  double depth_tolerance = 0.05;
};

/// What was found out about a pair of key frames.
struct LoopVerification {
  LoopVerdict verdict = LoopVerdict::kTooFewMatches;
  std::size_t matches = 0;       ///< By descriptor alone, both with depth.
  std::size_t inliers = 0;       ///< That agree with the final motion.
  std::size_t cells = 0;         ///< The smaller of the two images' counts.
  double support = 0.0;          ///< 0..1
  double coverage = 0.0;         ///< 0..1
  double depth_agreement = 0.0;  ///< 0..1
  Eigen::Isometry3d to_from = Eigen::Isometry3d::Identity();  ///< Camera `to` from camera `from`.
  /// Of delta = (rotation vector (rad), translation (m)), a motion in the frame of `to` that leads
  /// from to_from to the truth.
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Zero();
  std::vector<std::pair<int, int>> key_points;  ///< Inliers: key point of `from`, of `to`.
};

/// Whether two key frames see the same place, and from where: match by descriptor, 3D-3D RANSAC,
/// search around the motion it found, refinement by refinePose(), then the checks in the order of
/// LoopVerdict. A number that was not reached is 0.
/// @throws std::invalid_argument on inconsistent key frames, see checkLoopKeyFrame().
LoopVerification verifyLoop(const LoopKeyFrame& from, const LoopKeyFrame& to,
                            const PinholeCamera& camera,
                            const LoopVerificationOptions& options = {});

}  // namespace hmcdyn::slam

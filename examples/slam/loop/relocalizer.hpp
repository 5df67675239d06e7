// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include <hmcdyn/types.hpp>

#include "slam/loop/coverage.hpp"
#include "slam/loop/descriptor_matcher.hpp"
#include "slam/loop/loop_key_frame.hpp"
#include "slam/loop/place_index.hpp"
#include "slam/loop/rigid_ransac.hpp"

namespace hmcdyn::slam {

struct RelocalizerOptions {
  std::size_t max_candidates = 5;  ///< Key frames that are tried, those that look most alike.
  DescriptorMatcherOptions matcher;
  RigidRansacOptions ransac;
  std::size_t min_inliers = 20;  ///< For a pose.
  /// Key frames are tried, best first, until one gives a pose with so many inliers.
  std::size_t enough_inliers = 100;
  /// Fewer matches with a depth in both frames than this, and the pose comes from pixels alone
  /// (perspective n-point).
  std::size_t min_depth_pairs = 30;
  /// In this share of the squares where frame and key frame both have points, those of the key
  /// frame must be seen again: else it is a picture or a chair that is in two places.
  double min_coverage = 0.6;
  CoverageOptions coverage;
  int pnp_iterations = 300;       ///< Samples, >= 1.
  float pnp_reprojection = 4.0f;  ///< Largest error of an inlier in the samples (px).
};

/// What a lost frame and a key frame have in common.
struct RelocalizationMatch {
  int key_point = 0;            ///< Of the frame.
  int key_frame_key_point = 0;  ///< Of the key frame.
  int map_point = -1;           ///< That of the latter, or -1.
};

/// How a pose was found.
enum class RelocalizationMethod : std::uint8_t { kNone, kRigid, kPerspective };

struct RelocalizationResult {
  std::optional<Eigen::Isometry3d> camera_from_world;  ///< None: not found.
  std::size_t key_frame = 0;                           ///< Id of the one that it was found by.
  std::vector<RelocalizationMatch> matches;            ///< Inliers of the refined pose.
  RelocalizationMethod method = RelocalizationMethod::kNone;
  std::size_t tried = 0;         ///< Key frames that were matched.
  std::size_t most_matches = 0;  ///< By descriptor, with any of them.
  std::size_t most_inliers = 0;  ///< Of any of them, contradicted ones left out.
  std::size_t contradicted =
      0;  ///< Key frames that gave a pose which the rest of the frame denies.
};

/// Where a frame without a pose is: asks the index for key frames that look alike, matches, finds
/// the pose by 3D-3D RANSAC or, without depths, by OpenCV's perspective-n-point RANSAC (which draws
/// the same samples each time), and refines it by refinePose(). The key frame with the most inliers
/// of those that were tried counts, of equal ones the one that looks more alike. The pose may be in
/// another part of the map than the last one known; the caller decides whether to believe it.
///
/// @param frame its pose, id, map points and covisibility are not looked at; map_point may be
/// empty.
/// @param key_frames by id; those of the index that are not in it are skipped. Their poses and
///   depths make the points that the frame is placed by.
/// @throws std::invalid_argument on inconsistent key frames, see checkLoopKeyFrame(). Few, bad or
///   degenerate points only mean that nothing is found.
RelocalizationResult relocalize(const LoopKeyFrame& frame, const PlaceIndex& index,
                                const std::map<std::size_t, LoopKeyFrame>& key_frames,
                                const PinholeCamera& camera,
                                const RelocalizerOptions& options = {});

}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include <hmcdyn/types.hpp>

#include "slam/loop/loop_key_frame.hpp"

namespace hmcdyn::slam {

/// A point as one camera sees it.
struct SightedPoint {
  double u = 0.0;      ///< Column (px).
  double v = 0.0;      ///< Row (px).
  double depth = 0.0;  ///< Depth (m); not positive or not finite = none.
  double sigma = 1.0;  ///< Standard deviation of a pixel coordinate (px), > 0.
};

/// The same point, perhaps, as two cameras see it.
struct SightedPair {
  SightedPoint from;
  SightedPoint to;
};

struct RigidRansacOptions {
  DepthErrorModel depth_error;
  double chi2_pixel = 9.210;  ///< Inlier up to this squared distance in the image: 99 % of chi2(2).
  double chi2_depth = 6.635;  ///< And in depth: 99 % of chi2(1).
  int max_iterations = 500;   ///< Samples, >= 1.
  double confidence = 0.999;  ///< Of having drawn one sample of inliers only, 0..1; ends earlier.
  double min_area = 0.002;    ///< Of a sample's triangle (m^2): flatter ones say little.
  int refits = 4;             ///< Fits to all inliers at the end, >= 0; ends when nothing changes.
  std::uint32_t seed = 1;
};

struct RigidRansacResult {
  bool found = false;  ///< At least 3 pairs agree with to_from.
  Eigen::Isometry3d to_from = Eigen::Isometry3d::Identity();
  std::vector<std::uint8_t> inlier;  ///< One a pair.
  std::size_t inliers = 0;
  std::size_t usable = 0;  ///< Pairs that are finite and have both depths.
  int iterations = 0;      ///< Samples that were drawn.
};

/// Motion between two depth cameras from pairs of points of which many may be wrong (RANSAC,
/// Fischler and Bolles 1981): samples of three, the rigid motion by Umeyama (1991), inliers by
/// reprojection in both images and by depth, all in sigmas. A reprojection's variance is that of
/// both pixels and, along the epipolar line, that of the depth, which grows with the distance: a
/// far point may be off by more of a metre, but by no more of a pixel.
///
/// @throws std::invalid_argument on a sigma that is not positive and finite, focal lengths that are
///   not positive, or options out of their range. Whatever the pairs are, the result says it.
RigidRansacResult rigidRansac(const std::vector<SightedPair>& pairs, const PinholeCamera& camera,
                              const RigidRansacOptions& options = {});

}  // namespace hmcdyn::slam

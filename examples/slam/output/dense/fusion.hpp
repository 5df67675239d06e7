// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Geometry>

#include <hmcdyn/types.hpp>

#include "slam/output/dense/static_depth.hpp"
#include "slam/output/map_files.hpp"

namespace hmcdyn::slam {

struct FusionOptions {
  double voxel_size = 0.02;  ///< Side of the cubes that hold one point each (m). Above 0.
  /// Depths that differ by less than base + slope z^2 are of one surface (m, 1/m): poses err by
  /// centimetres, and the steps of a structured-light camera grow with z^2.
  double tolerance_base = 0.03;
  double tolerance_slope = 0.008;
  /// Key frames that must see a surface at a point, or all of them where there are fewer. A person
  /// who walks is rarely twice in one place.
  std::size_t min_sightings = 2;
  /// A point goes when this share of the key frames that have a say look through it: they see a
  /// surface behind it, so that the point's place is free. 0..1; 1 = no point goes so.
  double max_free_share = 0.3;
  std::size_t max_voxels = 4'000'000;  ///< Voxels beyond are not opened: bounds the memory.
};

/// A key frame with its final pose.
struct PosedKeyFrame {
  const ThinnedKeyFrame* images = nullptr;                              ///< Borrowed.
  Eigen::Isometry3d camera_from_world = Eigen::Isometry3d::Identity();  ///< Translation in m.
};

struct FusionResult {
  PointCloud cloud;
  std::size_t voxels = 0;     ///< With a usable depth.
  std::size_t rare = 0;       ///< Left out: seen by too few key frames.
  std::size_t free = 0;       ///< Left out: too many look through.
  bool is_truncated = false;  ///< FusionOptions::max_voxels was reached.
};

/// The dense map: the usable depths of all key frames in a voxel hash, a point a voxel at the mean
/// of its depths (weighted by 1 / z^2), then checked against each key frame's whole depth image, so
/// that what was there for a moment goes. The order of the points is that of the key frames.
/// A key frame whose pose is not finite is left out. No key frame gives no point.
/// @throws std::invalid_argument on options out of range or a null key frame.
FusionResult fuseKeyFrames(const std::vector<PosedKeyFrame>& key_frames,
                           const PinholeCamera& camera, const FusionOptions& options = {});

}  // namespace hmcdyn::slam

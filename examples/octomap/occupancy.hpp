// SPDX-License-Identifier: BSD-3-Clause
// An occupancy map of what does not move, by OctoMap and motion masks.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>

#include <octomap/OcTree.h>

namespace hmcdyn::occupancy {

/// What a map is made of.
struct OccupancyOptions {
  std::filesystem::path dataset;     ///< Folder in TUM format.
  std::string camera;                ///< As --camera of hmcdyn_slam.
  std::filesystem::path trajectory;  ///< TUM trajectory, camera in the world.
  /// Folder of motion masks, as hmcdyn_mask and hmcdyn_slam --write-masks write them: what is 128
  /// (stands, but may move) or more is left out, and so are frames without one. Empty = none.
  std::filesystem::path masks;
  double resolution = 0.05;  ///< Side of a voxel (m), more than 0.
  float max_depth = 4.0f;    ///< Farther pixels (m) are left out.
  int pixel_step = 8;        ///< Every so many columns and rows, at least 1.
};

/// The map from all frames with a pose.
/// @throws std::invalid_argument for an option out of range, std::runtime_error naming the file
/// that is missing or malformed.
std::unique_ptr<octomap::OcTree> buildMap(const OccupancyOptions& options);

/// Occupied voxels of a map.
struct GhostCount {
  std::size_t occupied = 0;
  std::size_t ghosts = 0;  ///< No static surface of any frame is in or beside them.
};

/// @param options of the recording; `masks` are true ones: what is not 0 there is no static
/// surface.
/// @throws as buildMap(), and std::invalid_argument without masks.
GhostCount countGhosts(const octomap::OcTree& map, const OccupancyOptions& options);

}  // namespace hmcdyn::occupancy

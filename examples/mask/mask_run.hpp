// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <hmcdyn/motion_mask.hpp>

#include "evaluate/trajectory.hpp"

namespace hmcdyn::masking {

/// What a run reads and writes.
struct MaskRunOptions {
  std::filesystem::path dataset;     ///< Folder in TUM format.
  std::filesystem::path camera;      ///< Calibration file.
  std::filesystem::path trajectory;  ///< TUM trajectory, camera in the world.
  std::filesystem::path output;      ///< Folder; made where it is missing.
  std::filesystem::path boxes;       ///< File of boxes; empty = no detector.
  std::size_t max_frames = 0;        ///< 0 = all.
  double max_pose_gap = 0.1;         ///< Between two poses that are interpolated (s).
  bool write_static_depth = false;   ///< OUTPUT/depth/STAMP.png: depth where nothing moves.
  bool annotate = false;             ///< OUTPUT/annotated/STAMP.jpg.
  MotionMaskOptions mask;
};

/// What became of the frames.
struct MaskRunCounts {
  std::size_t frames = 0;
  std::size_t judged = 0;     ///< With a good mask.
  std::size_t too_large = 0;  ///< With one that covers more than the options allow.
  std::size_t unknown = 0;    ///< All kUnknown: no pose, no depth, a jump.
  double milliseconds = 0.0;  ///< CPU time of the masks alone, a frame.
  double moving_share = 0.0;  ///< Mean.
};

/// The pose at a time: that of the stamp, or between its two neighbours.
/// @param max_gap between the neighbours (s). @return nothing where there is none.
std::optional<Eigen::Isometry3d> poseAt(const evaluate::Trajectory& trajectory, double timestamp,
                                        double max_gap);

/// Writes OUTPUT/mask/STAMP.png (8 bit) for each frame, and OUTPUT/things.csv.
/// @param progress is told of each frame that is done, of how many.
/// @param report takes a line for each frame that cannot be read.
/// @throws std::runtime_error naming the file that is missing, malformed or cannot be written.
MaskRunCounts writeMasks(const MaskRunOptions& options,
                         const std::function<void(std::size_t, std::size_t)>& progress,
                         const std::function<void(const std::string&)>& report);

}  // namespace hmcdyn::masking

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include <hmcdyn/span.hpp>

#include "slam/output/append_file.hpp"
#include "slam/output/tum_line.hpp"

namespace hmcdyn::slam {

// What is known of the map: key frames, loops, points. Each writer throws std::runtime_error,
// naming the file and the reason, when it cannot write; what the file held before stays.

/// keyframes.txt in TUM format. Grows with each key frame, and is replaced in one step when poses
/// are corrected: a reader finds the old poses or the new ones, never a mixture.
class KeyFramesWriter {
 public:
  explicit KeyFramesWriter(const std::filesystem::path& file);

  /// @throws std::invalid_argument where the stamp or the pose is not finite.
  void write(const StampedPose& key_frame);

  /// All key frames, in order of time, instead of what the file held. Later ones are appended.
  /// @throws std::invalid_argument as write(); the file stays as it is.
  void rewrite(const std::vector<StampedPose>& key_frames);

 private:
  AppendFile file_;
};

/// Two key frames that may show the same place.
struct LoopRow {
  double timestamp = 0.0;          ///< Of the current key frame (s).
  double matched_timestamp = 0.0;  ///< Of the older one (s).
  double score = 0.0;              ///< Likeness, as place recognition scores it; NaN = none.
  std::size_t inliers = 0;         ///< Points that agree with the motion between the two.
  std::string refusal;             ///< Why the loop was not closed; empty = accepted.
};

/// loops.csv: a header, then a row a candidate:
/// `timestamp,matched_timestamp,score,inliers,verdict`, the verdict "accepted" or the reason for
/// the refusal, quoted where it needs it (RFC 4180).
class LoopsWriter {
 public:
  explicit LoopsWriter(const std::filesystem::path& file);

  void write(const LoopRow& candidate);

 private:
  AppendFile file_;
};

/// Red, green, blue, 0..255.
using Colour = std::array<std::uint8_t, 3>;

/// N points with their colours: a dense map, or the sparse one.
struct PointCloud {
  std::vector<Eigen::Vector3f> position;  ///< In the world (m).
  std::vector<Colour> colour;             ///< N of them, or none: then all are light grey.
};

/// Writes a binary PLY file (little endian; x, y, z float, red, green, blue uchar), in one step: it
/// is there complete or not at all. Points with a coordinate that is not finite are left out.
/// @return points written.
/// @throws std::invalid_argument where there are colours, but not one a point.
std::size_t writePly(const std::filesystem::path& file, const PointCloud& cloud);

}  // namespace hmcdyn::slam

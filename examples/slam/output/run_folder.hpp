// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <nlohmann/json_fwd.hpp>

#include <hmcdyn/types.hpp>

#include "slam/output/stage_times.hpp"

namespace hmcdyn::slam {

/// A text file that grows line by line, each on disk before the next: what was written survives the
/// program's death.
class LineFile {
 public:
  /// Empties the file.
  /// @throws std::runtime_error naming the file and the reason when it cannot be written.
  explicit LineFile(std::filesystem::path file);

  /// Appends complete lines, newline included.
  /// @throws std::runtime_error naming the file and the reason, such as a full disk; earlier lines
  /// stay.
  void append(const std::string& lines);

 private:
  std::filesystem::path file_;
  std::ofstream stream_;
};

/// Makes the folder, with its parents; one that exists is used as it is, and the files of an earlier
/// run in it are replaced.
/// @throws std::runtime_error naming the folder and the reason where nothing can be written in it.
void makeRunFolder(const std::filesystem::path& folder);

/// A pose as a line of a TUM trajectory: timestamp tx ty tz qx qy qz qw, the camera in the world.
std::string trajectoryLine(double timestamp, const Eigen::Isometry3d& camera_from_world);

/// Header of timings.csv for the stages of a frame, and a frame's row: wall-clock time a stage (ms),
/// then the thread's processor time a stage (ms).
std::string timingsHeader(const StageTimes& frame);
std::string timingsRow(double timestamp, const StageTimes& frame);

/// Header of keypoints.csv, and a frame's rows: timestamp, pixel (px), depth (m, 0 = none), distance
/// (px, nan = none), cluster (-1 = none), label, weight.
/// @throws std::invalid_argument when sizes differ.
std::string keyPointsHeader();
std::string keyPointRows(double timestamp, const KeyPointsView& points, Span<const float> distance,
                         Span<const int> cluster, Span<const PointLabel> label,
                         Span<const float> weight);

/// Writes JSON to a file in one step: a reader finds the old content or the new, never a part.
/// @throws std::runtime_error naming the file and the reason.
void writeJson(const std::filesystem::path& file, const nlohmann::json& content);

}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <nlohmann/json_fwd.hpp>

#include <hmcdyn/types.hpp>

#include "slam/output/append_file.hpp"
#include "slam/output/map_files.hpp"
#include "support/stage_times.hpp"

namespace hmcdyn::slam {

// The writers below append a frame at a time; each throws std::runtime_error, naming the file and
// the reason, when it cannot write, and leaves the earlier frames in the file.

/// trajectory.txt in TUM format: `timestamp tx ty tz qx qy qz qw`, the camera's pose in the world.
class TrajectoryWriter {
 public:
  explicit TrajectoryWriter(const std::filesystem::path& file);

  /// @param timestamp s. @param camera_from_world translation in m; written is its inverse.
  /// @throws std::invalid_argument where the stamp or the pose is not finite.
  void write(double timestamp, const Eigen::Isometry3d& camera_from_world);

  /// The end of the file's life: all poses, in order of time, take the place of what it held, in
  /// one step, and that becomes `trajectory_online.txt` beside it. Nothing may be written after.
  /// @throws std::invalid_argument as write(); the file stays as it is.
  void finish(const std::vector<StampedPose>& poses);

 private:
  AppendFile file_;
};

/// timings.csv: a header, then a row a frame: the stamp (s), each stage's wall time, then each
/// stage's CPU time (ms), `nan` for a stage that the frame did not run.
class TimingsWriter {
 public:
  /// @param stages columns, in this order. @throws std::invalid_argument for a name that is empty,
  /// comes twice, or holds a comma, a quote or a line break.
  TimingsWriter(const std::filesystem::path& file, std::vector<std::string> stages);

  /// @throws std::invalid_argument for a stage that has no column.
  void write(double timestamp, const support::StageTimes& times);

 private:
  std::vector<std::string> stages_;
  AppendFile file_;
};

/// A frame's key points and what the filter made of them. Arrays of one size, borrowed.
struct LabelledKeyPoints {
  KeyPointsView points;
  Span<const float> distances;    ///< Epipolar distances (px), NaN = none.
  Span<const int> clusters;       ///< -1 = none.
  Span<const PointLabel> labels;  ///< Verdicts.
  Span<const float> weights;      ///< 0..1.
  Span<const float> sizes;        ///< Diameters of the described patches (px).
};

/// keypoints.csv: a header, then a row a key point:
/// `timestamp,u,v,depth,distance,cluster,label,weight,size`, NaN as `nan`.
class KeyPointsWriter {
 public:
  explicit KeyPointsWriter(const std::filesystem::path& file);

  /// @throws std::invalid_argument where the arrays differ in size.
  void write(double timestamp, const LabelledKeyPoints& frame);

 private:
  AppendFile file_;
};

/// The folder of a run's results. Keeps 1 MiB of its disk free for their end: see releaseReserve().
class RunFolder {
 public:
  /// Creates the folder with its parents where it is missing. A folder that exists is used as it
  /// is: of what it holds, the files below are removed, so that none is left of an earlier
  /// run; other files stay.
  /// @throws std::runtime_error naming the folder and the reason where it cannot be created or
  /// the reserve cannot be written in it.
  explicit RunFolder(std::filesystem::path folder);

  const std::filesystem::path& path() const noexcept { return folder_; }

  /// Gives the reserve back to the disk: where that is full, the run's end still finds room for
  /// the trajectory and the summary.
  void releaseReserve() { reserve_.reset(); }

  TrajectoryWriter trajectory() const;                           ///< trajectory.txt
  TimingsWriter timings(std::vector<std::string> stages) const;  ///< timings.csv
  KeyPointsWriter keyPoints() const;                             ///< keypoints.csv
  KeyFramesWriter keyFrames() const;                             ///< keyframes.txt
  LoopsWriter loops() const;                                     ///< loops.csv

  /// Writes map.ply as writePly() does. @return points written.
  std::size_t writeMap(const PointCloud& cloud) const;

  /// Writes report.html in one step. @throws std::runtime_error naming the file and the reason.
  void writeReport(const std::string& html) const;

  /// Writes summary.json in one step: it is there complete or not at all. Numbers that are not
  /// finite become null. @throws std::runtime_error naming the file and the reason.
  void writeSummary(const nlohmann::json& summary) const;

 private:
  std::filesystem::path folder_;
  std::optional<AppendFile>
      reserve_;  ///< Without a name: it goes with the process, however killed.
};

}  // namespace hmcdyn::slam

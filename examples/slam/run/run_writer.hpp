// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "slam/output/append_file.hpp"
#include "slam/output/map_files.hpp"
#include "slam/output/report/frame_history.hpp"
#include "slam/output/report/pictures.hpp"
#include "slam/output/report/report.hpp"
#include "slam/output/run_folder.hpp"
#include "slam/run/detection_feed.hpp"
#include "slam/run/options.hpp"
#include "slam/run/pipeline.hpp"

namespace hmcdyn::slam {

/// Stages of a frame, the columns of timings.csv. All but "detect" are the tracking thread's.
std::vector<std::string> frameStages();

/// The files of a run, written as frames are done, so that a run that is killed keeps what it had;
/// and what the report needs of each frame.
class RunWriter {
 public:
  explicit RunWriter(const SlamOptions& options);

  /// @throws std::runtime_error naming the file where one cannot be written.
  void write(const FrameOutcome& outcome, const Map& map, LoopClosing& loops);

  /// Appends to boxes.txt, where it is asked for. @param lines FrameBoxes::found.
  /// @throws std::runtime_error naming the file where it cannot be written.
  void writeBoxes(const std::string& lines);

  /// Makes room for what follows where the disk is full.
  void releaseReserve() { folder_.releaseReserve(); }

  /// Rows for the candidates whose fate was decided since; write() does it for each frame.
  void writeLoops(const Map& map, LoopClosing& loops);

  /// The poses as they are at the end, in place of those of the moment.
  void finish(const std::vector<StampedPose>& poses, const Map& map);

  void writeMap(const PointCloud& cloud) const;
  void writeSummary(const nlohmann::json& summary) const { folder_.writeSummary(summary); }

  /// report.html. @param groundtruth empty = none.
  void writeReport(const nlohmann::json& summary, const std::filesystem::path& groundtruth,
                   const SlamOptions& options);

 private:
  void writeKeyPoints(const FrameOutcome& outcome);
  void writePicture(const FrameOutcome& outcome);
  void record(const FrameOutcome& outcome);
  void rewriteKeyFrames(const Map& map);

  RunFolder folder_;
  TrajectoryWriter trajectory_;
  TimingsWriter timings_;
  KeyFramesWriter key_frames_;
  LoopsWriter loops_;
  std::optional<KeyPointsWriter> key_points_;
  std::optional<AppendFile> boxes_;
  std::filesystem::path pictures_;  ///< Empty = no picture a frame.
  std::vector<std::string> class_names_;
  bool reports_;
  FrameHistory report_frames_;
  std::vector<LoopRow> loop_rows_;
  PictureReel reel_;
};

}  // namespace hmcdyn::slam

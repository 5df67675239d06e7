// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include <hmcdyn/dynamic_feature_filter.hpp>

#include "slam/detect/box_plausibility.hpp"
#include "slam/detect/detection_thread.hpp"
#include "slam/input/source/frame_source.hpp"
#include "slam/run/options.hpp"
#include "slam/run/part_errors.hpp"
#include "slam/run/pipeline.hpp"
#include "slam/track/tracker.hpp"

namespace hmcdyn::slam {

/// What a run counted.
struct RunCounts {
  std::size_t frames_tracked = 0;
  std::size_t key_frames = 0;
  std::size_t frames_with_boxes = 0;
  std::size_t frames_with_distances = 0;  ///< At least one key point had a distance.
  std::size_t boxes = 0;
  std::size_t dynamic_boxes = 0;
  std::size_t key_points = 0;
  std::map<std::string, std::size_t> labels;        ///< Key points by verdict.
  std::map<std::string, std::size_t> motion_masks;  ///< Frames by what their mask is worth.
  std::map<std::string, std::size_t> models;        ///< Frame pairs by motion model.
  std::size_t models_by_memory = 0;                 ///< Pairs without background, see MatchSource.
  std::size_t models_by_prediction = 0;             ///< Pairs by where the tracker expected it.
  std::size_t frames_camera_unknown = 0;            ///< Nobody knew how the camera had moved.
  std::size_t frames_starved = 0;                   ///< Points were kept for their number.
  std::map<std::string, std::size_t> fundamental;   ///< Frame pairs by verdict on F.
  std::map<std::string, std::size_t> failures;      ///< Frames without a pose, by reason.
  std::vector<double> lost;                         ///< Their time stamps (s), the first 1000.
  std::size_t relocalized = 0;                      ///< Times that the camera was found again.
  std::size_t frames_carried = 0;                   ///< By the filter's odometry, map not found.
  std::size_t boxes_bridged = 0;                    ///< Boxes that the detector missed.
  std::size_t map_points = 0;                       ///< Of the dense map.
  bool stopped = false;                             ///< By a signal.
  std::size_t frames_expected = 0;                  ///< To the end; 0 where a camera has none.
  std::vector<std::string> write_failures;          ///< File and reason; the first ended the run.
  std::vector<double> latency_ms;  ///< In real time: from a frame's due time to its pose.
  std::vector<PartError> errors;   ///< What parts of the system threw.
  SourceCounts source;
  DetectionCounts detections;
  BoxCounts box_file;              ///< Of --detector file.
  std::vector<std::string> notes;  ///< What was assumed or is odd about the input.

  void add(const DynamicFeatureFilterResult& filtered);
  void add(double timestamp, const TrackingResult& tracked);
};

/// One sentence a reason why the filter, though asked for, had nothing to judge by; empty if it
/// had.
std::vector<std::string> filterWarnings(const RunCounts& counts, const SlamOptions& options);

/// Where fewer than half of the frames have a pose: one sentence on what was missing. Empty
/// otherwise.
std::string whyFewPoses(const RunCounts& counts);

/// Where a detector failed more than once, of which only the first time was told: how often, and
/// the last time, which says whether it was given up. Empty otherwise.
std::string laterFailures(const DetectionCounts& counts);

/// What the run was made with, in words.
struct RunNames {
  std::string source;
  std::string detector;
};

/// summary.json. @param groundtruth empty = none.
nlohmann::json summarizeRun(const SlamOptions& options, const RunNames& names,
                            const RunCounts& counts, const Pipeline& pipeline,
                            const support::StageHistory& times,
                            const std::filesystem::path& groundtruth);

/// The options as JSON, complete enough to repeat the run.
nlohmann::json toJson(const SlamOptions& options, const std::string& detector_name);

/// The counts as JSON, with the tracking rate (eq. 11).
nlohmann::json toJson(const RunCounts& counts);

/// The exit code for a run that came to its end with a pose for fewer than half of its frames.
inline constexpr int kFewPoses = 3;

/// What hmcdyn_slam ends with: 0; 1 where a result could not be written or a part of the system
/// threw; else kFewPoses where fewer than half of the frames have a pose. @param summary of
/// runSlam().
int exitCodeOf(const nlohmann::json& summary);

/// Versions of this library and of what it was built with.
nlohmann::json libraryVersions();

}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include <hmcdyn/depth_error.hpp>
#include <hmcdyn/frame_filter.hpp>

#include "slam/detect/detector_options.hpp"
#include "slam/features/orb_extractor.hpp"
#include "slam/input/dataset/tum_dataset.hpp"
#include "slam/input/source/depth_camera.hpp"
#include "slam/loop/loop_closing.hpp"
#include "slam/map/local_mapper.hpp"
#include "slam/track/tracker.hpp"

namespace hmcdyn::slam {

/// How time passes.
enum class RunMode : std::uint8_t {
  kOffline,   ///< Every frame waits for its detection; with one seed the same result bit for bit.
  kRealtime,  ///< Frames come by their stamps; tracking waits for nobody, late frames are dropped.
};

/// Where frames come from.
enum class SourceKind : std::uint8_t { kFolder, kLive };

/// Folders of a run's output for SlamOptions::write_masks and write_static_depth.
inline constexpr const char* kMaskFolder = "masks";
inline constexpr const char* kStaticDepthFolder = "static_depth";

/// Everything that a run depends on.
struct SlamOptions {
  RunMode mode = RunMode::kOffline;
  SourceKind source = SourceKind::kFolder;
  std::filesystem::path dataset;  ///< Folder in TUM format.
  double speed = 1.0;             ///< Real time: so many times as fast as it was recorded.
  std::size_t held_images = 3;    ///< Real time: images that wait at most for a late tracker.
  DepthCameraOptions live;        ///< The camera of SourceKind::kLive.
  DatasetOptions association;
  std::string camera = "tum3";  ///< Preset or calibration file.
  DetectorOptions detector;
  /// Boxes that the detector missed are carried on by optical flow for so long (s); 0 = never.
  double bridge = 0.5;
  OrbOptions features;
  /// Up to so many times as many key points where boxes cover much of the image; 1 = never.
  double max_feature_factor = 2.5;
  FrameFilterOptions filter;
  std::string filter_name = "robust";  ///< As --filter has it.
  Ablation ablation = Ablation::kNone;
  TrackerOptions tracker;
  LocalMapperOptions mapping;
  LoopClosingOptions loops;
  std::filesystem::path output;       ///< Folder for the results.
  std::filesystem::path groundtruth;  ///< Empty = groundtruth.txt of the data set, where it is.
  std::uint32_t seed = 1;             ///< Of every random draw.
  std::size_t max_frames = 0;         ///< 0 = all.
  bool annotate = false;              ///< A picture a frame.
  bool write_keypoints = false;       ///< keypoints.csv.
  bool write_boxes = false;           ///< boxes.txt.
  bool write_masks = false;           ///< A motion mask a frame, in masks/.
  bool write_static_depth = false;    ///< The depth of what does not move, in static_depth/.
  bool dense_map = true;              ///< map.ply.
  bool write_report = true;           ///< report.html.
  bool quiet = false;                 ///< No progress bar.
};

/// Passes the seed on to every step that draws, and the mode to the threads: offline their answers
/// are waited for, so that runs repeat; in real time they are taken when they come.
void prepareOptions(SlamOptions& options);

/// The options of a run with a camera that errs so: whatever weighs a depth goes by one model.
SlamOptions withDepthError(SlamOptions options, const DepthErrorModel& depth_error);

}  // namespace hmcdyn::slam

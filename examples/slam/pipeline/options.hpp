// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include "slam/dataset/tum_dataset.hpp"
#include "slam/detection/detector_options.hpp"
#include "slam/features/orb_extractor.hpp"
#include "slam/filtering/motion_filter.hpp"
#include "slam/mapping/local_mapper.hpp"
#include "slam/tracking/tracker.hpp"

namespace hmcdyn::slam {

/// Everything that a run depends on.
struct SlamOptions {
  std::filesystem::path dataset;  ///< Folder in TUM format.
  DatasetOptions association;
  std::string camera = "tum3";  ///< Preset or calibration file.
  DetectorOptions detector;
  OrbOptions features;
  /// Up to so many times as many key points where boxes cover much of the image; 1 = never.
  double max_feature_factor = 2.5;
  MotionFilterOptions filter;
  TrackerOptions tracker;
  LocalMapperOptions mapping;
  std::filesystem::path output;       ///< Folder for the results.
  std::filesystem::path groundtruth;  ///< Empty = groundtruth.txt of the data set, where it is.
  std::uint32_t seed = 1;             ///< Of every random draw.
  std::size_t max_frames = 0;         ///< 0 = all.
  bool annotate = false;              ///< A picture a frame.
  bool write_keypoints = false;       ///< keypoints.csv.
  bool quiet = false;                 ///< No progress bar.
};

/// Passes SlamOptions::seed on to every step that draws.
void distributeSeed(SlamOptions& options);

}  // namespace hmcdyn::slam

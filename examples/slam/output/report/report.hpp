// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "evaluate/absolute_trajectory_error.hpp"
#include "slam/output/map_files.hpp"

namespace hmcdyn::slam {

/// Three NaN: a position that is not known.
inline Eigen::Vector3d unknownPosition() {
  return Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
}

/// What the report says of a frame. A value that is not finite is shown as missing.
struct ReportFrame {
  double timestamp = 0.0;                        ///< s.
  Eigen::Vector3d position = unknownPosition();  ///< Camera in the world (m), NaN = not tracked.
  Eigen::Vector3d truth = unknownPosition();     ///< Of the ground truth (m), NaN = none.
  double error = std::numeric_limits<double>::quiet_NaN();  ///< Of the position (m), NaN = unknown.
  std::vector<double> stage_ms;      ///< Wall time by ReportInput::stages, NaN = not run.
  std::size_t static_points = 0;     ///< Key points by verdict.
  std::size_t suspect_points = 0;    ///< In a dynamic box, kept.
  std::size_t dynamic_points = 0;    ///< On a moving thing.
  std::size_t unmatched_points = 0;  ///< Without a distance.
  std::size_t boxes = 0;             ///< Of the detector.
  std::size_t dynamic_boxes = 0;     ///< Those that move.
  std::string model;                 ///< Verdict on the camera's motion, "fundamental"; "" = none.
  std::string failure;               ///< Why the frame was lost; "" = tracked.
  bool key_frame = false;
  /// In the run, from 0; nothing where it is the place in ReportInput::frames.
  std::optional<std::size_t> number = std::nullopt;
};

struct ReportPicture {
  std::string caption;
  std::string jpeg;  ///< Bytes of a JPEG file.
};

/// All that the report shows. Texts may hold any bytes.
struct ReportInput {
  std::string title;                ///< Such as the data set's name.
  std::vector<std::string> stages;  ///< Names of a frame's stages, in order.
  std::vector<ReportFrame> frames;  ///< In order of time; else the charts go by number.
  /// Frames of the run, where `frames` does not hold all of them any more; 0 = it does.
  std::size_t frames_in_all = 0;
  std::vector<LoopRow> loops;
  std::vector<ReportPicture> pictures;  ///< Beyond 8 MB they are left out, and the page says so.
  /// As summary.json has it. Known here: "evaluation" (ate_m, rpe_*), "options", "versions",
  /// "warnings", "counts"; all of it is optional.
  nlohmann::json summary = nlohmann::json::object();
};

/// The frames with their ground truth: positions of all frames are brought into the truth's world,
/// and truth and error are filled in where the result has the frame's time stamp (within 10 us, as
/// trajectory files round to 1 us).
std::vector<ReportFrame> withGroundTruth(std::vector<ReportFrame> frames,
                                         const evaluate::AteResult& result);

/// One page without links to anything outside: headline figures, trajectory, charts that can be
/// zoomed, pictures, tables. Charts by uPlot (MIT licence, its notice is in the page).
/// @throws std::invalid_argument where a frame has not one time a stage.
std::string renderReport(const ReportInput& input);

/// Writes the page in one step.
/// @throws std::invalid_argument as renderReport(); std::runtime_error naming file and reason.
void writeReport(const std::filesystem::path& file, const ReportInput& input);

}  // namespace hmcdyn::slam

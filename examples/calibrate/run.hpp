// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calibrate/correction_fit.hpp"
#include "calibrate/depth_to_color.hpp"
#include "calibrate/error_statistics.hpp"
#include "calibrate/triangulation.hpp"
#include "slam/input/camera/depth_error_file.hpp"

namespace hmcdyn::calibrate {

struct CalibrationOptions {
  std::filesystem::path dataset;     ///< Folder in TUM format; nothing in it moves.
  std::string camera;                ///< Name of a preset, or a calibration file.
  std::filesystem::path trajectory;  ///< TUM format; empty = from the images.
  bool scale_known = false;          ///< The trajectory was not made with this camera's depth.
  double position_sigma = 0.005;     ///< Of the trajectory's positions (m), > 0.
  int images = 60;                   ///< Of the recording, spread evenly, >= 3.
  bool correct = true;               ///< False: the error is measured and nothing taken out.
};

/// What a recording tells of its depth camera.
struct Calibration {
  cv::Size image;          ///< Size of the images (px).
  std::size_t images = 0;  ///< With a pose.
  Triangulation triangulation;
  std::vector<DepthSample> samples;
  CorrectionFit fit;
  bool corrects = false;   ///< The correction helped where it had not looked.
  ErrorStatistics before;  ///< Of the depths as measured.
  ErrorStatistics after;   ///< Of the depths as corrected by a fit that had not seen them.
  DepthErrorModel model_before;
  DepthErrorModel model_after;
  DepthToColor to_color;
  std::vector<std::string> notes;  ///< What was assumed of the files or is odd, a sentence each.
};

/// Measures a depth camera: points followed through the images, triangulated, compared with their
/// depth.
/// @throws std::invalid_argument for options out of range.
/// @throws std::runtime_error naming the file that cannot be read, or what the recording lacks.
Calibration calibrateDepth(const CalibrationOptions& options);

/// What the camera's file shall say of the depth.
slam::DepthSettings settingsOf(const Calibration& calibration);

/// The camera's file as text: that of `camera` where it is a file, else written anew from the
/// preset; without depth settings.
std::string cameraText(const std::string& camera);

/// Where the correction was measured, and that it is a guess elsewhere: a sentence.
std::string describeKnown(const CorrectionFit& fit);

/// The result as a table for people.
std::string describe(const Calibration& calibration, const CalibrationOptions& options);

}  // namespace hmcdyn::calibrate

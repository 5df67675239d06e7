// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <hmcdyn/depth_error.hpp>
#include <hmcdyn/types.hpp>

#include "slam/input/camera/depth_correction.hpp"

namespace hmcdyn::slam {

/// What is known of an RGB-D camera whose depth is registered to its colour.
struct CameraCalibration {
  PinholeCamera pinhole;
  /// Brown-Conrady coefficients k1, k2, p1, p2, k3, in OpenCV's order. All 0 = no distortion.
  std::array<double, 5> distortion{};
  double depth_factor = 5000.0;       ///< Depth image's value of one metre. Above 0.
  int width = 640;                    ///< Columns of the images (px). 0 = the images say it.
  int height = 480;                   ///< Rows of the images (px). 0 = the images say it.
  double frame_rate = 30.0;           ///< Frames a second. Above 0.
  std::optional<double> baseline_fx;  ///< Stereo baseline times fx (m px), where it is known.
  DepthErrorModel depth_error;        ///< Of the depth after its correction; structured light's.
  DepthCorrection depth_correction;   ///< Of the rectified depth image; none unless calibrated.
};

/// True where one of the distortion coefficients is not 0.
bool hasDistortion(const CameraCalibration& calibration);

/// Names of the built-in calibrations: tum1, tum2, tum3 (freiburg1-3 of the TUM RGB-D benchmark)
/// and bonn (BONN RGB-D Dynamic). Their depth error is that of structured light: a Kinect v1 or an
/// Xtion recorded all of them.
std::vector<std::string> cameraPresetNames();

/// A built-in calibration by name, nothing where there is none of that name.
std::optional<CameraCalibration> findCameraPreset(const std::string& name);

/// A calibration by the name of a preset or the path of a file for readCalibrationFile(). A preset
/// wins over a file of the same name.
/// @throws std::invalid_argument that lists the presets where it is neither and no path.
/// @throws std::runtime_error where a path (with a folder or an extension) leads to no file, or as
/// readCalibrationFile().
CameraCalibration loadCamera(const std::string& preset_or_file);

}  // namespace hmcdyn::slam

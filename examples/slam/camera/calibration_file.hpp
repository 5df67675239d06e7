// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "slam/camera/calibration.hpp"

namespace hmcdyn::slam {

/// Reads a calibration from YAML in one of two spellings. Ours knows these keys, and no other:
///
///   fx, fy         focal lengths (px), above 0                              required
///   cx, cy         principal point (px)                                     required
///   width, height  image size (px), whole numbers above 0                   required
///   depth_factor   depth image's value of one metre, above 0                required
///   distortion     list k1, k2, p1, p2 and perhaps k3 (OpenCV's order),     default 0
///                  or one by one under the keys k1, k2, p1, p2, k3
///   frame_rate     frames a second, above 0                                 default 30
///   baseline_fx    stereo baseline times fx (m px), above 0                 default unknown
///
/// A settings file of ORB-SLAM3, which is taken for one where a key starts with "Camera", has the
/// same under Camera.fx or Camera1.fx (and so on to k3), Camera.width, Camera.height, Camera.fps,
/// DepthMapFactor or RGBD.DepthMapFactor, and Camera.bf or Stereo.b; its other keys are not read.
/// @throws std::runtime_error that names file, key and, where there is one, line: file missing,
/// not YAML, a key missing, of the wrong type or out of range, a camera model without pinhole.
CameraCalibration readCalibrationFile(const std::filesystem::path& file);

}  // namespace hmcdyn::slam

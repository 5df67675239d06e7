// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "slam/input/camera/calibration.hpp"

namespace hmcdyn::slam {

/// Reads a calibration from YAML. Ours knows these keys, and no other:
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
/// A settings file of another system is read for what we need of it, its other keys do not matter:
/// ORB-SLAM2 and 3 and their forks (Camera.fx or Camera1.fx and so on to k3, Camera.width,
/// Camera.height, Camera.fps, DepthMapFactor or RGBD.DepthMapFactor, Camera.bf or Stereo.b),
/// stella_vslam (the same nested, cols, rows, depthmap_factor), and others that have an fx
/// somewhere, a camera_matrix as OpenCV and ROS write it, or Kalibr's intrinsics. Without a size,
/// width and height are 0: the images say it (fittedTo()).
/// Either kind may have the keys of readDepthSettings(): sensor, depth_error, depth_correction.
/// @throws std::runtime_error that names file, key and, where there is one, line: file missing,
/// a key that we need missing, given twice, no YAML, of the wrong type or out of range, a camera
/// model without pinhole, a distortion with k4 to k6; or whatIsImplausible().
CameraCalibration readCalibrationFile(const std::filesystem::path& file);

}  // namespace hmcdyn::slam

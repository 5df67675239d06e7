// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "evaluate/trajectory.hpp"
#include "slam/detect/box_plausibility.hpp"
#include "slam/input/camera/calibration.hpp"
#include "slam/input/dataset/recording.hpp"
#include "slam/run/options.hpp"

namespace hmcdyn::slam {

/// What a run works on, read and found plausible before its first frame.
struct RunInput {
  CameraCalibration calibration;      ///< With the size of the images.
  FrameList list;                     ///< Of a folder; empty for a live camera.
  std::filesystem::path groundtruth;  ///< One that can be used; empty = none.
  BoxCounts boxes;                    ///< Of --detector file.
  std::vector<std::string> notes;     ///< What was assumed or is odd, a sentence each.
};

/// Reads calibration, lists, ground truth and boxes, looks at a few of the images, and tells the
/// detector what it should know of the frames (DetectorOptions::frames). A ground truth that the
/// user named and that cannot be used is an error, the data set's own is a note.
/// @param own_detector the caller brings one: boxes from a file play no part.
/// @throws std::invalid_argument and std::runtime_error as openRecording(), readTrajectoryFor() and
/// reviewBoxes().
RunInput checkInput(SlamOptions& options, bool own_detector);

}  // namespace hmcdyn::slam

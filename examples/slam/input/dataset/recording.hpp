// SPDX-License-Identifier: BSD-3-Clause
// A folder of frames and its camera, read and found plausible before the first frame.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "slam/input/camera/calibration.hpp"
#include "slam/input/dataset/tum_dataset.hpp"

namespace hmcdyn::slam {

/// A folder of frames and its camera.
struct Recording {
  CameraCalibration calibration;  ///< With the size of the images.
  FrameList list;                 ///< Its notes tell of the camera, too.
};

/// What is known of the frames that boxes from a file belong to.
struct FramesOfBoxes {
  cv::Size image;             ///< Of every frame (px); 0 x 0 = not known.
  std::vector<double> times;  ///< Time stamps in rising order (s); empty = not known.
  double unit_seconds = 1.0;  ///< What a time stamp of 1 means in the frames' own list (s).
};

/// Reads calibration and lists, and looks at a few of the images, spread over the recording.
/// @param camera as loadCamera() takes it. @param options but for the frame rate, the camera's.
/// @throws std::invalid_argument and std::runtime_error as loadCamera(), readFrameList() and
/// fittedTo(), and where nothing says the images' size.
Recording openRecording(const std::filesystem::path& folder, const std::string& camera,
                        DatasetOptions options = {});

/// @throws std::runtime_error where a calibration does not say the images' size. @param source why
/// nothing else does, to end the message with.
void requireSize(const CameraCalibration& calibration, const std::string& camera,
                 const char* source);

/// What boxes from a file are checked against.
FramesOfBoxes framesOfBoxes(const CameraCalibration& calibration, const FrameList& list);

}  // namespace hmcdyn::slam

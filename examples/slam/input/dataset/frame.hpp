// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include <opencv2/core.hpp>

#include "slam/input/camera/calibration.hpp"
#include "slam/input/camera/rectifier.hpp"
#include "slam/input/dataset/tum_dataset.hpp"

namespace hmcdyn::slam {

/// A colour image with its registered depth, all of one size.
struct RgbdFrame {
  std::size_t index = 0;   ///< Place in the data set's list, from 0.
  double timestamp = 0.0;  ///< Of the colour image (s); formatTimestamp() writes it back.
  cv::Mat bgr;             ///< CV_8UC3.
  cv::Mat gray;            ///< CV_8UC1, of bgr.
  cv::Mat depth;           ///< CV_32FC1, metres, 0 = none; never negative or NaN.
};

/// Reads a frame as the camera saw it, lens distortion included. The colour image may be grey or
/// have an alpha channel; the depth image must have one channel of 16 bits, which are divided by
/// the calibration's depth factor.
/// @throws std::runtime_error that names the file where one is missing, truncated, no image, of
/// another type, or of another size than the calibration's. Other frames can still be loaded.
RgbdFrame loadFrame(const FrameEntry& entry, const CameraCalibration& calibration);

/// The frame as a pinhole camera would have seen it, its depth without what the calibration's
/// depth_correction knows; without distortion and correction it shares its images with the
/// argument.
/// @throws std::invalid_argument where the frame's size is not the calibration's.
RgbdFrame rectify(const RgbdFrame& frame, const Rectifier& rectifier);

}  // namespace hmcdyn::slam

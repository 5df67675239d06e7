// SPDX-License-Identifier: BSD-3-Clause
// What a calibration can be: the one place that says so.
#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "slam/input/camera/calibration.hpp"

namespace hmcdyn::slam {

/// What cannot be in a calibration, with what was expected and, where it can be told, the values
/// that would fit: focal lengths that are shares of the image or those of no lens, a principal
/// point outside the image, intrinsics of another resolution, a depth factor below 1 or above 1e6,
/// a baseline of no camera. Empty where it is plausible. Without the size of the images only what
/// does not need it.
std::string whatIsImplausible(const CameraCalibration& calibration);

/// What cameras seldom have, a sentence each: pixels that are not square, a principal point far
/// from the centre.
std::vector<std::string> whatIsUnusual(const CameraCalibration& calibration);

/// True for a stereo baseline times fx (m px) of a camera: baselines of 5 mm to 5 m.
bool isBaseline(double baseline_fx, double fx);

/// The calibration for images of a size, which it takes where it has none.
/// @param name of the camera, for the message.
/// @throws std::runtime_error where it is for images of another size, or whatIsImplausible().
CameraCalibration fittedTo(CameraCalibration calibration, cv::Size image, const std::string& name);

/// What is odd about the depths of some frames, with the depth factor that would fit: a median
/// beyond 20 m or below 5 cm; nearer and smaller throughout than depth cameras see, as millimetres
/// read with a factor of 5000 are; a median beyond 10 m, as TUM's depths read as millimetres have;
/// the same depth nearly everywhere; steps of five times or a fifth of what a Kinect's disparities
/// make.
/// Empty where nothing is, or there is no depth.
/// @param depths in metres, above 0, of whole images.
std::string whatIsOddAbout(std::vector<float> depths, double depth_factor);

}  // namespace hmcdyn::slam

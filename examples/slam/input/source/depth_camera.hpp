// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace hmcdyn::slam {

/// What a depth camera handed out.
struct CameraImages {
  double timestamp = 0.0;  ///< When it was grabbed: seconds since 1970, as in TUM's files.
  cv::Mat color;           ///< CV_8UC3 (BGR) or CV_8UC1. Valid until the next read.
  /// CV_16UC1 in units of depthUnit(), or CV_32FC1 in them; registered to the colour image; empty
  /// where the camera gave none. Valid until the next read.
  cv::Mat depth;
};

/// The seam between a camera's driver and LiveSource, which tests fill with a fake camera.
class DepthCamera {
 public:
  DepthCamera() = default;
  virtual ~DepthCamera() = default;
  DepthCamera(const DepthCamera&) = delete;
  DepthCamera& operator=(const DepthCamera&) = delete;
  DepthCamera(DepthCamera&&) = delete;
  DepthCamera& operator=(DepthCamera&&) = delete;

  /// Waits for the next images; nothing where the camera gives no more, such as when it was
  /// unplugged.
  virtual std::optional<CameraImages> read() = 0;

  /// Metres of one unit of the depth images.
  virtual double depthUnit() const = 0;

  /// For reports: "OpenNI2 camera 0".
  virtual std::string name() const = 0;
};

/// Which camera of OpenCV's videoio.
struct DepthCameraOptions {
  std::string backend = "openni2";  ///< One of depthCameraBackends().
  int index = 0;                    ///< Which of the cameras of that kind, from 0.
};

/// "openni2" (Kinect, Xtion, Astra) and "realsense".
std::vector<std::string> depthCameraBackends();

/// Opens a camera and asks it to register its depth to the colour image.
/// @throws std::invalid_argument for an unknown backend or a negative index.
/// @throws std::runtime_error that says whether this OpenCV was built without the backend, or has
/// it and found no such camera.
std::unique_ptr<DepthCamera> openDepthCamera(const DepthCameraOptions& options);

}  // namespace hmcdyn::slam

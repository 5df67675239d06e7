// SPDX-License-Identifier: BSD-3-Clause
#include "slam/input/source/depth_camera.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <stdexcept>

#include <fmt/format.h>
#include <opencv2/videoio.hpp>
#include <opencv2/videoio/registry.hpp>

namespace hmcdyn::slam {
namespace {

/// What videoio calls a kind of camera and its images. Both deliver millimetres by default.
struct Backend {
  const char* name;
  const char* title;
  cv::VideoCaptureAPIs api;
  int color;         ///< Channel of retrieve().
  int depth;         ///< Channel of retrieve().
  int registration;  ///< Property that registers depth to colour; -1 = the backend always does.
};

constexpr double kMillimetre = 0.001;

const std::array<Backend, 2> kBackends{{
    {"openni2", "OpenNI2", cv::CAP_OPENNI2, cv::CAP_OPENNI_BGR_IMAGE, cv::CAP_OPENNI_DEPTH_MAP,
     static_cast<int>(cv::CAP_OPENNI_DEPTH_GENERATOR) + cv::CAP_PROP_OPENNI_REGISTRATION},
    {"realsense", "RealSense", cv::CAP_REALSENSE, cv::CAP_INTELPERC_IMAGE,
     cv::CAP_INTELPERC_DEPTH_MAP, -1},
}};

double secondsSince1970() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

class VideoIoCamera final : public DepthCamera {
 public:
  VideoIoCamera(const Backend& backend, int index, const cv::VideoCapture& capture)
      : backend_(backend), index_(index), capture_(capture) {}

  std::optional<CameraImages> read() override {
    if (!capture_.grab()) {
      return std::nullopt;
    }
    CameraImages images;
    images.timestamp = secondsSince1970();
    if (!capture_.retrieve(images.color, backend_.color)) {
      images.color.release();
    }
    if (!capture_.retrieve(images.depth, backend_.depth)) {
      images.depth.release();
    }
    return images;
  }
  double depthUnit() const override { return kMillimetre; }
  std::string name() const override { return fmt::format("{} camera {}", backend_.title, index_); }

 private:
  Backend backend_;
  int index_;
  cv::VideoCapture capture_;  ///< Copies share the device.
};

const Backend& findBackend(const std::string& name) {
  for (const Backend& backend : kBackends) {
    if (name == backend.name) {
      return backend;
    }
  }
  throw std::invalid_argument(fmt::format("depth camera '{}' is unknown; expected one of {}", name,
                                          fmt::join(depthCameraBackends(), ", ")));
}

std::string cameraBackendsOfOpenCv() {
  std::vector<std::string> names;
  for (const cv::VideoCaptureAPIs api : cv::videoio_registry::getCameraBackends()) {
    names.push_back(cv::videoio_registry::getBackendName(api));
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

std::vector<std::string> depthCameraBackends() {
  std::vector<std::string> names;
  names.reserve(kBackends.size());
  for (const Backend& backend : kBackends) {
    names.emplace_back(backend.name);
  }
  return names;
}

std::unique_ptr<DepthCamera> openDepthCamera(const DepthCameraOptions& options) {
  const Backend& backend = findBackend(options.backend);
  if (options.index < 0) {
    throw std::invalid_argument(
        fmt::format("DepthCameraOptions::index is {}; expected 0 or more", options.index));
  }
  const std::vector<cv::VideoCaptureAPIs> built = cv::videoio_registry::getCameraBackends();
  if (std::find(built.begin(), built.end(), backend.api) == built.end()) {
    throw std::runtime_error(fmt::format(
        "{} camera {}: this OpenCV {} was built without {}; its camera backends are {}. Record a "
        "folder in TUM format instead, or build OpenCV with {}",
        backend.title, options.index, CV_VERSION, backend.title, cameraBackendsOfOpenCv(),
        backend.title));
  }
  cv::VideoCapture capture;
  if (!capture.open(options.index, backend.api)) {
    throw std::runtime_error(fmt::format("{} camera {}: not found; is it plugged in, and free?",
                                         backend.title, options.index));
  }
  if (backend.registration >= 0 && !capture.set(backend.registration, 1.0)) {
    throw std::runtime_error(
        fmt::format("{} camera {}: cannot register its depth to the colour image", backend.title,
                    options.index));
  }
  return std::make_unique<VideoIoCamera>(backend, options.index, capture);
}

}  // namespace hmcdyn::slam

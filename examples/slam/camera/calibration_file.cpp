// SPDX-License-Identifier: BSD-3-Clause
#include "slam/camera/calibration_file.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include "slam/dataset/file_io.hpp"

namespace hmcdyn::slam {
namespace {

constexpr std::array<const char*, 5> kDistortionKeys{"k1", "k2", "p1", "p2", "k3"};

// Checked access to the keys of one file.
class Settings {
 public:
  explicit Settings(std::filesystem::path file) : file_(std::move(file)) {
    std::string text = readFile(file_);
    // OpenCV heads its files with "%YAML:1.0", which is no YAML directive; blanked, so that the
    // line numbers stay.
    if (text.rfind("%YAML:", 0) == 0) {
      std::fill(text.begin(), std::find(text.begin(), text.end(), '\n'), ' ');
    }
    try {
      root_ = YAML::Load(text);
    } catch (const YAML::Exception& error) {
      throw failure(error.mark, "is not YAML: " + error.msg);
    }
    if (!root_.IsMap()) {
      throw failure(YAML::Mark::null_mark(), "expected lines \"key: value\"");
    }
  }

  std::vector<std::string> keys() const {
    std::vector<std::string> keys;
    for (const auto& entry : root_) {
      keys.push_back(entry.first.Scalar());
    }
    return keys;
  }

  bool has(const std::string& key) const { return node(key).IsDefined(); }

  double number(const std::string& key) const { return toNumber(required(key), key); }

  double positive(const std::string& key) const {
    const double value = number(key);
    if (!(value > 0.0)) {
      throw failure(node(key).Mark(),
                    fmt::format("{} is {}; expected a number above 0", key, value));
    }
    return value;
  }

  int positiveInteger(const std::string& key) const {
    const double value = positive(key);
    if (value != std::floor(value) || value > std::numeric_limits<int>::max()) {
      throw failure(node(key).Mark(),
                    fmt::format("{} is {}; expected a whole number above 0", key, value));
    }
    return static_cast<int>(value);
  }

  std::string text(const std::string& key) const { return required(key).Scalar(); }

  std::vector<double> numbers(const std::string& key) const {
    const YAML::Node list = required(key);
    if (!list.IsSequence()) {
      throw failure(list.Mark(), fmt::format("{}: expected a list of numbers", key));
    }
    std::vector<double> values;
    for (const YAML::Node& element : list) {
      values.push_back(toNumber(element, key));
    }
    return values;
  }

  // "FILE:LINE: key message", without the line where the key is missing.
  std::runtime_error failure(const std::string& key, const std::string& message) const {
    return failure(has(key) ? node(key).Mark() : YAML::Mark::null_mark(), key + " " + message);
  }

 private:
  YAML::Node node(const std::string& key) const { return root_[key]; }

  YAML::Node required(const std::string& key) const {
    if (!has(key)) {
      throw failure(key, "is missing");
    }
    return node(key);
  }

  double toNumber(const YAML::Node& value, const std::string& key) const {
    double number = 0.0;
    if (!value.IsScalar() || !YAML::convert<double>::decode(value, number) ||
        !std::isfinite(number)) {
      throw failure(value.Mark(), value.IsScalar() ? fmt::format("{} is '{}'; expected a number",
                                                                 key, value.Scalar())
                                                   : fmt::format("{}: expected a number", key));
    }
    return number;
  }

  std::runtime_error failure(const YAML::Mark& mark, const std::string& message) const {
    if (mark.is_null()) {
      return std::runtime_error(fmt::format("{}: {}", file_.string(), message));
    }
    return errorAt(file_, static_cast<std::size_t>(mark.line) + 1, message);
  }

  std::filesystem::path file_;
  YAML::Node root_;
};

// Focal lengths, principal point and the single coefficients, each key with the prefix in front.
void readIntrinsics(const Settings& settings, const std::string& prefix,
                    CameraCalibration& calibration) {
  calibration.pinhole.fx = settings.positive(prefix + "fx");
  calibration.pinhole.fy = settings.positive(prefix + "fy");
  calibration.pinhole.cx = settings.number(prefix + "cx");
  calibration.pinhole.cy = settings.number(prefix + "cy");
  for (std::size_t i = 0; i < kDistortionKeys.size(); ++i) {
    const std::string key = prefix + kDistortionKeys[i];
    calibration.distortion[i] = settings.has(key) ? settings.number(key) : 0.0;
  }
}

void readDistortionList(const Settings& settings, CameraCalibration& calibration) {
  const std::vector<double> list = settings.numbers("distortion");
  if (list.size() != 4 && list.size() != 5) {
    throw settings.failure("distortion", fmt::format("has {} numbers; expected k1, k2, p1, p2 and "
                                                     "perhaps k3",
                                                     list.size()));
  }
  for (const char* key : kDistortionKeys) {
    if (settings.has(key)) {
      throw settings.failure(key, "is given twice: alone and in the list \"distortion\"");
    }
  }
  std::copy(list.begin(), list.end(), calibration.distortion.begin());
}

// A misspelt optional key would be taken for a default.
void refuseUnknownKeys(const Settings& settings) {
  const std::vector<std::string> known{
      "fx", "fy", "cx", "cy", "width",        "height",     "distortion", "k1",
      "k2", "p1", "p2", "k3", "depth_factor", "frame_rate", "baseline_fx"};
  for (const std::string& key : settings.keys()) {
    if (std::find(known.begin(), known.end(), key) == known.end()) {
      throw settings.failure(key,
                             fmt::format("is no key; expected one of {}", fmt::join(known, ", ")));
    }
  }
}

CameraCalibration readOwn(const Settings& settings) {
  CameraCalibration calibration;
  readIntrinsics(settings, "", calibration);
  if (settings.has("distortion")) {
    readDistortionList(settings, calibration);
  }
  calibration.depth_factor = settings.positive("depth_factor");
  calibration.width = settings.positiveInteger("width");
  calibration.height = settings.positiveInteger("height");
  if (settings.has("frame_rate")) {
    calibration.frame_rate = settings.positive("frame_rate");
  }
  if (settings.has("baseline_fx")) {
    calibration.baseline_fx = settings.positive("baseline_fx");
  }
  refuseUnknownKeys(settings);
  return calibration;
}

CameraCalibration readOrbSlam3(const Settings& settings) {
  const std::string type = settings.has("Camera.type") ? settings.text("Camera.type") : "PinHole";
  if (type != "PinHole" && type != "Rectified") {
    throw settings.failure("Camera.type",
                           fmt::format("is '{}'; expected PinHole or Rectified", type));
  }
  CameraCalibration calibration;
  readIntrinsics(settings, settings.has("Camera1.fx") ? "Camera1." : "Camera.", calibration);
  calibration.depth_factor = settings.positive(
      settings.has("RGBD.DepthMapFactor") ? "RGBD.DepthMapFactor" : "DepthMapFactor");
  calibration.width = settings.positiveInteger("Camera.width");
  calibration.height = settings.positiveInteger("Camera.height");
  if (settings.has("Camera.fps")) {
    calibration.frame_rate = settings.positive("Camera.fps");
  }
  if (settings.has("Stereo.b")) {
    calibration.baseline_fx = settings.positive("Stereo.b") * calibration.pinhole.fx;
  } else if (settings.has("Camera.bf")) {
    calibration.baseline_fx = settings.positive("Camera.bf");
  }
  return calibration;
}

}  // namespace

CameraCalibration readCalibrationFile(const std::filesystem::path& file) {
  const Settings settings(file);
  const std::vector<std::string> keys = settings.keys();
  const bool orb_slam3 = std::any_of(
      keys.begin(), keys.end(), [](const std::string& key) { return key.rfind("Camera", 0) == 0; });
  return orb_slam3 ? readOrbSlam3(settings) : readOwn(settings);
}

}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#include "slam/input/camera/calibration_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "slam/input/camera/depth_error_file.hpp"
#include "slam/input/camera/plausibility.hpp"
#include "slam/input/camera/settings_file.hpp"
#include "support/text_table.hpp"

namespace hmcdyn::slam {
namespace {

constexpr std::array<const char*, 5> kDistortionKeys{"k1", "k2", "p1", "p2", "k3"};
constexpr std::array<const char*, 3> kRationalKeys{"k4", "k5", "k6"};

// What others call the depth factor, as the last part of a key in lower case.
const std::vector<std::string>& foreignDepthFactors() {
  static const std::vector<std::string> names{
      "depthmapfactor",  "depthmap_factor", "depth_map_factor", "depthfactor",
      "png_depth_scale", "depth_scale",     "depthscale",       "depth_scaling_factor"};
  return names;
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

std::string lastPart(const std::string& key) { return key.substr(key.rfind('.') + 1); }

// The first key with this last part, whatever it is nested in; empty where there is none.
std::string keyEndingIn(const SettingsFile& settings, const std::vector<std::string>& parts) {
  for (const std::string& part : parts) {
    for (const Setting& setting : settings.settings()) {
      if (lower(lastPart(setting.key)) == part) {
        return setting.key;
      }
    }
  }
  return {};
}

void refuseRationalModel(const SettingsFile& settings, const std::string& prefix) {
  for (const char* name : kRationalKeys) {
    const std::string key = prefix + name;
    if (settings.has(key) && settings.number(key) != 0.0) {
      throw settings.failure(
          key, fmt::format("is {}; expected 0: distortion is k1, k2, p1, p2 and k3 here; rectify "
                           "the images, or calibrate without the rational model",
                           settings.number(key)));
    }
  }
}

// Focal lengths, principal point and the single coefficients, each key with the prefix in front.
void readIntrinsics(const SettingsFile& settings, const std::string& prefix,
                    CameraCalibration& calibration) {
  calibration.pinhole.fx = settings.positive(prefix + "fx");
  calibration.pinhole.fy = settings.positive(prefix + "fy");
  calibration.pinhole.cx = settings.number(prefix + "cx");
  calibration.pinhole.cy = settings.number(prefix + "cy");
  for (std::size_t i = 0; i < kDistortionKeys.size(); ++i) {
    const std::string key = prefix + kDistortionKeys.at(i);
    calibration.distortion.at(i) = settings.has(key) ? settings.number(key) : 0.0;
  }
}

void readDistortionList(const SettingsFile& settings, const std::string& key,
                        CameraCalibration& calibration) {
  std::vector<double> list = settings.numbers(key);
  const std::size_t used = static_cast<std::size_t>(
      std::find_if(list.rbegin(), list.rend(), [](double value) { return value != 0.0; }).base() -
      list.begin());
  if (list.size() > kDistortionKeys.size() && used <= kDistortionKeys.size()) {
    list.resize(kDistortionKeys.size());  // a model with more coefficients, which are 0
  }
  if (list.size() != 4 && list.size() != 5) {
    throw settings.failure(
        key, fmt::format("has {} numbers; expected k1, k2, p1, p2 and perhaps k3{}", list.size(),
                         list.size() > kDistortionKeys.size()
                             ? ": rectify the images of a camera with the rational model"
                             : ""));
  }
  std::copy(list.begin(), list.end(), calibration.distortion.begin());
}

// A misspelt optional key would be taken for a default.
void refuseUnknownKeys(const SettingsFile& settings) {
  const std::vector<std::string> known{
      "fx",           "fy",         "cx",          "cy",     "width",       "height",
      "distortion",   "k1",         "k2",          "p1",     "p2",          "k3",
      "depth_factor", "frame_rate", "baseline_fx", "sensor", "depth_error", "depth_correction"};
  for (const Setting& setting : settings.settings()) {
    const std::string outermost = setting.key.substr(0, setting.key.find('.'));
    const bool may_nest = outermost == "depth_error" || outermost == "depth_correction";
    if (std::find(known.begin(), known.end(), may_nest ? outermost : setting.key) == known.end()) {
      throw settings.failure(setting.key,
                             fmt::format("is no key; expected one of {}", fmt::join(known, ", ")));
    }
  }
}

CameraCalibration readOwn(const SettingsFile& settings) {
  CameraCalibration calibration;
  readIntrinsics(settings, "", calibration);
  if (settings.has("distortion")) {
    readDistortionList(settings, "distortion", calibration);
    for (const char* key : kDistortionKeys) {
      if (settings.has(key)) {
        throw settings.failure(key, "is given twice: alone and in the list \"distortion\"");
      }
    }
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

// Whose the camera is among several: the first. Nothing where no key is a focal length.
std::optional<std::string> prefixOf(const SettingsFile& settings) {
  for (const char* prefix : {"Camera1.", "Camera."}) {
    for (const char* name : {"fx", "fy", "cx", "cy"}) {
      if (settings.has(std::string(prefix) + name)) {
        return prefix;
      }
    }
  }
  const std::string key = keyEndingIn(settings, {"fx"});
  return key.empty() ? std::nullopt
                     : std::optional(key.substr(0, key.size() - lastPart(key).size()));
}

// A pinhole with k1, k2, p1, p2 and k3, by any of its names. The rational model is one where its
// other coefficients are 0, as is seen when they are read.
bool isOurModel(const std::string& name) {
  std::string letters;
  std::copy_if(name.begin(), name.end(), std::back_inserter(letters),
               [](unsigned char c) { return std::isalnum(c) != 0; });
  const std::vector<std::string> known{"pinhole",
                                       "rectified",
                                       "perspective",
                                       "radtan",
                                       "plumbbob",
                                       "brown",
                                       "brownconrady",
                                       "opencv",
                                       "pinholeradtan",
                                       "pinholebrown",
                                       "pinholebrownconrady",
                                       "none",
                                       "radialtangential",
                                       "rationalpolynomial",
                                       "undistorted"};
  return std::find(known.begin(), known.end(), lower(letters)) != known.end();
}

// "Camera.type", "Camera.model", "model_type", "camera_model", and what lenses are said to do.
void requirePinhole(const SettingsFile& settings) {
  const std::string camera =
      settings.firstOf({"Camera.type", "Camera.model", "model_type", "camera_model",
                        "cam0.camera_model", "Camera0.model"});
  const std::string distortion = keyEndingIn(settings, {"distortion_model", "distortion_type"});
  for (const std::string& model : {camera, distortion}) {
    if (!model.empty() && !settings.text(model).empty() && !isOurModel(settings.text(model))) {
      throw settings.failure(
          model, fmt::format("is '{}'; expected PinHole or Rectified, with k1, k2, p1, p2 and k3 "
                             "(radtan, plumb_bob): rectify the images for others",
                             support::printable(settings.text(model))));
    }
  }
}

std::string parentOf(const std::string& key) {
  return key.substr(0, key.size() - lastPart(key).size());
}

// What is distortion by its name, and of the same camera: a list, as ROS, OpenCV, EuRoC and Kalibr
// write it, or k1, k2, ... in a group of its own. Others than these are another camera's.
void readForeignDistortion(const SettingsFile& settings, const std::string& prefix,
                           CameraCalibration& calibration) {
  const std::string beside = parentOf(prefix.substr(0, prefix.size() - (prefix.empty() ? 0 : 1)));
  for (const std::string& parent : {prefix, beside}) {
    for (const char* group : {"distortion_parameters.", "distortion."}) {
      if (settings.has(parent + group + "k1")) {
        for (std::size_t i = 0; i < kDistortionKeys.size(); ++i) {
          const std::string key = parent + group + kDistortionKeys.at(i);
          calibration.distortion.at(i) = settings.has(key) ? settings.number(key) : 0.0;
        }
        refuseRationalModel(settings, parent + group);
        return;
      }
    }
    for (const char* name :
         {"distortion_coefficients", "distortion_coeffs", "Distortion_Coefficients", "distCoeffs",
          "dist_coeffs", "distortion", "D", "d"}) {
      const std::string key = settings.firstOf({parent + name + ".data", parent + name});
      const Setting* const found = key.empty() ? nullptr : settings.find(key);
      if (found != nullptr && found->is_list && !found->scalars.empty()) {
        readDistortionList(settings, key, calibration);
        return;
      }
    }
  }
}

// A camera matrix by rows, as OpenCV and ROS write it, or fx, fy, cx, cy in a list, as Kalibr does.
bool readMatrix(const SettingsFile& settings, CameraCalibration& calibration) {
  const std::string matrix =
      settings.firstOf({"camera_matrix.data", "cameraMatrix.data", "Camera_Matrix.data", "K.data",
                        "K", "Camera.K", "k"});
  const std::string list = settings.firstOf({"cam0.intrinsics", "intrinsics", "Camera.intrinsics"});
  const std::string& key = matrix.empty() ? list : matrix;
  if (key.empty()) {
    return false;
  }
  const std::vector<double> values = settings.numbers(key);
  const bool square = values.size() == 9;
  if (!square && values.size() != 4) {
    throw settings.failure(
        key, fmt::format("has {} numbers; expected the 9 of a camera matrix, or fx, fy, cx, cy",
                         values.size()));
  }
  calibration.pinhole = square ? PinholeCamera{values[0], values[4], values[2], values[5]}
                               : PinholeCamera{values[0], values[1], values[2], values[3]};
  if (!(calibration.pinhole.fx > 0.0 && calibration.pinhole.fy > 0.0)) {
    throw settings.failure(key, "has a focal length that is not above 0");
  }
  readForeignDistortion(settings, parentOf(key.substr(0, key.rfind(".data"))), calibration);
  return true;
}

// 0 where no key says it: the images do. Matrices have rows and columns, too, so not every key will
// do.
void readSize(const SettingsFile& settings, const std::string& prefix,
              CameraCalibration& calibration) {
  const auto side = [&](const char* name, const char* lines, const char* letter) {
    const std::string key =
        settings.firstOf({prefix + name, std::string("Camera.") + name,
                          std::string("image_") + name, prefix + "image_" + name, prefix + lines,
                          std::string("Camera.") + lines, prefix + letter, name});
    return key.empty() ? 0 : settings.positiveInteger(key);
  };
  calibration.width = side("width", "cols", "W");
  calibration.height = side("height", "rows", "H");
  const std::string resolution = settings.firstOf({"cam0.resolution", "resolution"});
  if (calibration.width == 0 && !resolution.empty()) {
    const std::vector<double> sides = settings.numbers(resolution);
    if (sides.size() == 2 && sides[0] >= 1.0 && sides[1] >= 1.0 && sides[0] < 1e5 &&
        sides[1] < 1e5) {
      calibration.width = static_cast<int>(sides[0]);
      calibration.height = static_cast<int>(sides[1]);
    }
  }
  if (calibration.width == 0 || calibration.height == 0) {
    calibration.width = 0;
    calibration.height = 0;
  }
}

double readDepthFactor(const SettingsFile& settings) {
  std::string key = settings.firstOf({"RGBD.DepthMapFactor", "DepthMapFactor"});
  if (key.empty()) {
    key = keyEndingIn(settings, foreignDepthFactors());
  }
  if (key.empty()) {
    key = keyEndingIn(settings, {"depth_factor"});
  }
  if (key.empty()) {
    throw settings.failure(
        "DepthMapFactor is missing: this is the file of a camera without depth, such as KITTI's? "
        "Add \"DepthMapFactor: 5000\", the value of one metre in the depth images (TUM 5000, "
        "millimetres 1000)");
  }
  return settings.positive(key);
}

// Of other systems. What we do not need is not looked at.
CameraCalibration readForeign(const SettingsFile& settings) {
  requirePinhole(settings);
  CameraCalibration calibration;
  const std::optional<std::string> prefix = prefixOf(settings);
  if (prefix) {
    readIntrinsics(settings, *prefix, calibration);
    refuseRationalModel(settings, *prefix);
    if (!settings.has(*prefix + kDistortionKeys.front())) {
      readForeignDistortion(settings, *prefix, calibration);
    }
  } else if (!readMatrix(settings, calibration)) {
    std::vector<std::string> some;
    for (const Setting& setting : settings.settings()) {
      some.push_back(setting.key);
      constexpr std::size_t kNamed = 5;
      if (some.size() == kNamed) {
        break;
      }
    }
    if (settings.has("intrinsic_matrix")) {
      throw settings.failure(
          "intrinsic_matrix",
          "is not read: it is Open3D's, by columns; expected fx, fy, cx, cy and depth_factor");
    }
    throw settings.failure(fmt::format(
        "has no focal length (fx, Camera.fx, Camera1.fx, a camera_matrix); its keys are {}, ...: "
        "is it the settings file of a camera?",
        fmt::join(some, ", ")));
  }
  calibration.depth_factor = readDepthFactor(settings);
  readSize(settings, prefix.value_or(""), calibration);
  const std::string rate = keyEndingIn(settings, {"fps", "frame_rate"});
  if (!rate.empty() && settings.number(rate) > 0.0) {  // 0: as fast as it goes
    calibration.frame_rate = settings.number(rate);
  }
  // A file may hold any baseline, as nothing here depends on it.
  const std::string metres = settings.firstOf({"Stereo.b"});
  const std::string product = settings.firstOf({"Camera.bf", "Camera.focal_x_baseline"});
  const std::string& key = metres.empty() ? product : metres;
  if (!key.empty()) {
    const double value = settings.number(key) * (metres.empty() ? 1.0 : calibration.pinhole.fx);
    if (isBaseline(value, calibration.pinhole.fx)) {
      calibration.baseline_fx = value;
    }
  }
  return calibration;
}

// Others write fx and fy without a prefix, too, but call the depth factor otherwise.
bool isOwn(const SettingsFile& settings) {
  const bool plain = !settings.firstOf({"fx", "fy", "cx", "cy"}).empty();
  return plain &&
         (settings.has("depth_factor") || keyEndingIn(settings, foreignDepthFactors()).empty());
}

}  // namespace

CameraCalibration readCalibrationFile(const std::filesystem::path& file) {
  const SettingsFile settings(file);
  CameraCalibration calibration = isOwn(settings) ? readOwn(settings) : readForeign(settings);
  const std::string wrong = whatIsImplausible(calibration);
  if (!wrong.empty()) {
    throw settings.failure(wrong);
  }
  const DepthSettings depth = readDepthSettings(settings);
  calibration.depth_error = depth.error;
  calibration.depth_correction = depth.correction;
  return calibration;
}

}  // namespace hmcdyn::slam

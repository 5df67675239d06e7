// SPDX-License-Identifier: BSD-3-Clause
#include "slam/input/camera/calibration.hpp"

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <stdexcept>

#include <fmt/format.h>

#include "slam/input/camera/calibration_file.hpp"

namespace hmcdyn::slam {
namespace {

struct Preset {
  const char* name = nullptr;
  PinholeCamera pinhole;
  std::array<double, 5> distortion{};
};

// Colour cameras of the TUM RGB-D benchmark (freiburg1-3; the images of the third are already
// rectified) and of BONN RGB-D Dynamic. All 640 x 480 at 30 Hz with a depth factor of 5000.
constexpr std::array<Preset, 4> kPresets{{
    {"tum1",
     {517.306408, 516.469215, 318.643040, 255.313989},
     {0.262383, -0.953104, -0.005358, 0.002628, 1.163314}},
    {"tum2",
     {520.908620, 521.007327, 325.141442, 249.701764},
     {0.231222, -0.784899, -0.003257, -0.000105, 0.917205}},
    {"tum3", {535.4, 539.2, 320.1, 247.6}, {0.0, 0.0, 0.0, 0.0, 0.0}},
    {"bonn",
     {542.822841, 542.576870, 315.593520, 237.756098},
     {0.039903, -0.099343, -0.000730, -0.000144, 0.0}},
}};

// Levenshtein's distance: the least number of letters inserted, removed or replaced.
std::size_t editDistance(const std::string& from, const std::string& to) {
  std::vector<std::size_t> row(to.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < from.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < to.size(); ++j) {
      const std::size_t replaced = diagonal + (from[i] == to[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({row[j] + 1, diagonal + 1, replaced});
    }
  }
  return row.back();
}

}  // namespace

bool hasDistortion(const CameraCalibration& calibration) {
  return std::any_of(calibration.distortion.begin(), calibration.distortion.end(),
                     [](double coefficient) { return coefficient != 0.0; });
}

std::vector<std::string> cameraPresetNames() {
  std::vector<std::string> names;
  names.reserve(kPresets.size());
  for (const Preset& preset : kPresets) {
    names.emplace_back(preset.name);
  }
  return names;
}

std::optional<CameraCalibration> findCameraPreset(const std::string& name) {
  for (const Preset& preset : kPresets) {
    if (name == preset.name) {
      CameraCalibration calibration;
      calibration.pinhole = preset.pinhole;
      calibration.distortion = preset.distortion;
      return calibration;
    }
  }
  return std::nullopt;
}

CameraCalibration loadCamera(const std::string& preset_or_file) {
  if (const auto preset = findCameraPreset(preset_or_file)) {
    return *preset;
  }
  if (std::filesystem::exists(preset_or_file)) {
    return readCalibrationFile(preset_or_file);
  }
  const std::filesystem::path path(preset_or_file);
  if (path.has_extension() || path.has_parent_path()) {
    throw std::runtime_error(fmt::format("camera {}: no such file", preset_or_file));
  }
  const std::vector<std::string> names = cameraPresetNames();
  const auto nearest = std::min_element(
      names.begin(), names.end(), [&](const std::string& left, const std::string& right) {
        return editDistance(preset_or_file, left) < editDistance(preset_or_file, right);
      });
  throw std::invalid_argument(
      fmt::format("camera '{}' is neither a preset ({}) nor a file; did you mean '{}'?",
                  preset_or_file, fmt::join(names, ", "), *nearest));
}

}  // namespace hmcdyn::slam

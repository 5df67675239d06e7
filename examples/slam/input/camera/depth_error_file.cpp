// SPDX-License-Identifier: BSD-3-Clause
#include "slam/input/camera/depth_error_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace hmcdyn::slam {
namespace {

constexpr std::array<std::pair<DepthSensor, const char*>, 3> kSensors{
    {{DepthSensor::kStructuredLight, "structured_light"},
     {DepthSensor::kTimeOfFlight, "time_of_flight"},
     {DepthSensor::kActiveStereo, "active_stereo"}}};

constexpr const char* kSensorKey = "sensor";
constexpr const char* kErrorKey = "depth_error";
constexpr const char* kCorrectionKey = "depth_correction";
constexpr const char* kOriginMark = "# depth: ";

/// The keys below one of a file's, with errors that name the line.
class DepthKeys {
 public:
  DepthKeys(const SettingsFile& settings, std::string name)
      : settings_(settings), name_(std::move(name)) {
    if (settings_.find(name_) != nullptr) {
      throw settings_.failure(name_, "has no keys below it; expected lines \"key: value\"");
    }
  }

  void refuseOthersThan(const std::vector<std::string>& known) const {
    for (const Setting& setting : settings_.settings()) {
      const std::string key = isBelow(setting, name_) ? setting.key.substr(name_.size() + 1) : "";
      if (!key.empty() && std::find(known.begin(), known.end(), key) == known.end()) {
        throw settings_.failure(
            setting.key, fmt::format("is no key; expected one of {}", fmt::join(known, ", ")));
      }
    }
  }

  bool has(const char* key) const { return settings_.has(full(key)); }

  double number(const char* key) const { return settings_.number(full(key)); }

  int count(const char* key) const {
    const double value = number(key);
    if (value != std::floor(value) || value < 0.0 || value > 1000.0) {
      throw settings_.failure(full(key),
                              fmt::format("is {}; expected a whole number from 0 to 1000", value));
    }
    return static_cast<int>(value);
  }

  std::vector<double> numbers(const char* key) const { return settings_.numbers(full(key)); }

  std::runtime_error failure(const std::string& message) const {
    const auto first =
        std::find_if(settings_.settings().begin(), settings_.settings().end(),
                     [this](const Setting& setting) { return isBelow(setting, name_); });
    return settings_.failure(first->key, fmt::format("and the keys beside it: {}", message));
  }

  static bool isBelow(const Setting& setting, const std::string& name) {
    return setting.key.rfind(name + ".", 0) == 0;
  }

 private:
  std::string full(const char* key) const { return name_ + "." + key; }

  const SettingsFile& settings_;
  std::string name_;
};

/// Whether the file has a key, with or without keys below it.
bool mentions(const SettingsFile& settings, const std::string& name) {
  return std::any_of(settings.settings().begin(), settings.settings().end(),
                     [&name](const Setting& setting) {
                       return setting.key == name || DepthKeys::isBelow(setting, name);
                     });
}

DepthErrorModel readModel(const DepthKeys& keys, DepthErrorModel model) {
  keys.refuseOthersThan(
      {"noise_floor", "noise_quadratic", "systematic_linear", "systematic_quadratic"});
  const auto read = [&keys](const char* key, float& field) {
    if (keys.has(key)) {
      field = static_cast<float>(keys.number(key));
    }
  };
  read("noise_floor", model.noise_floor);
  read("noise_quadratic", model.noise_quadratic);
  read("systematic_linear", model.systematic_linear);
  read("systematic_quadratic", model.systematic_quadratic);
  try {
    checkModel(model);
  } catch (const std::invalid_argument& error) {
    throw keys.failure(error.what());
  }
  return model;
}

DepthCorrection readCorrection(const DepthKeys& keys) {
  keys.refuseOthersThan({"scale", "rows", "columns", "growth"});
  DepthCorrection correction;
  if (keys.has("scale")) {
    correction.scale = keys.number("scale");
  }
  if (keys.has("rows") || keys.has("columns") || keys.has("growth")) {
    correction.rows = keys.count("rows");
    correction.columns = keys.count("columns");
    correction.growth = keys.numbers("growth");
  }
  try {
    checkCorrection(correction);
  } catch (const std::invalid_argument& error) {
    throw keys.failure(error.what());
  }
  return correction;
}

bool startsWith(const std::string& line, const std::string& with) {
  return line.rfind(with, 0) == 0;
}

std::string withoutDepthSettings(const std::string& text) {
  std::istringstream lines(text);
  std::string kept;
  bool inside = false;  // of a block that goes
  for (std::string line; std::getline(lines, line);) {
    const bool indented = !line.empty() && (line[0] == ' ' || line[0] == '\t');
    const bool opens = startsWith(line, std::string(kSensorKey) + ":") ||
                       startsWith(line, std::string(kErrorKey) + ":") ||
                       startsWith(line, std::string(kCorrectionKey) + ":");
    inside = opens || (inside && indented);
    if (!inside && !startsWith(line, kOriginMark)) {
      kept += line + "\n";
    }
  }
  return kept;
}

}  // namespace

std::vector<std::string> depthSensorNames() {
  std::vector<std::string> names;
  names.reserve(kSensors.size());
  for (const auto& sensor : kSensors) {
    names.emplace_back(sensor.second);
  }
  return names;
}

const char* toString(DepthSensor sensor) noexcept {
  for (const auto& known : kSensors) {
    if (known.first == sensor) {
      return known.second;
    }
  }
  return "unknown";
}

std::optional<DepthSensor> findDepthSensor(const std::string& name) {
  for (const auto& known : kSensors) {
    if (name == known.second) {
      return known.first;
    }
  }
  return std::nullopt;
}

DepthErrorModel defaultDepthError(DepthSensor sensor) {
  switch (sensor) {
    case DepthSensor::kTimeOfFlight:
      return {0.001f, 1.3e-3f, 0.0055f, 0.0f};
    case DepthSensor::kActiveStereo:
      return {0.001f, 3.8e-3f, 0.0f, 0.005f};
    case DepthSensor::kStructuredLight:
      break;
  }
  return {};
}

DepthSettings readDepthSettings(const SettingsFile& settings) {
  DepthSettings depth;
  if (settings.has(kSensorKey)) {
    const std::string name = settings.text(kSensorKey);
    const std::optional<DepthSensor> known = findDepthSensor(name);
    if (!known) {
      throw settings.failure(kSensorKey, fmt::format("is '{}'; expected one of {}", name,
                                                     fmt::join(depthSensorNames(), ", ")));
    }
    depth.sensor = *known;
  }
  depth.error = defaultDepthError(depth.sensor);
  if (mentions(settings, kErrorKey)) {
    depth.error = readModel(DepthKeys(settings, kErrorKey), depth.error);
  }
  if (mentions(settings, kCorrectionKey)) {
    depth.correction = readCorrection(DepthKeys(settings, kCorrectionKey));
  }
  return depth;
}

std::string withDepthSettings(const std::string& text, const DepthSettings& settings,
                              const std::vector<std::string>& origin) {
  std::string result = withoutDepthSettings(text);
  for (const std::string& line : origin) {
    result += kOriginMark + line + "\n";
  }
  const DepthErrorModel& error = settings.error;
  result += fmt::format(
      "{}: {}\n{}:\n  noise_floor: {:.6g}\n  noise_quadratic: {:.6g}\n"
      "  systematic_linear: {:.6g}\n  systematic_quadratic: {:.6g}\n",
      kSensorKey, toString(settings.sensor), kErrorKey, error.noise_floor, error.noise_quadratic,
      error.systematic_linear, error.systematic_quadratic);
  const DepthCorrection& correction = settings.correction;
  if (isIdentity(correction)) {
    return result;
  }
  result += fmt::format("{}:\n  scale: {:.6f}\n", kCorrectionKey, correction.scale);
  if (correction.rows > 0) {
    result +=
        fmt::format("  rows: {}\n  columns: {}\n  growth: [", correction.rows, correction.columns);
    for (std::size_t i = 0; i < correction.growth.size(); ++i) {
      const bool new_line = i % static_cast<std::size_t>(correction.columns) == 0;
      result += fmt::format("{}{}{:.6f}", i > 0 ? "," : "", new_line ? "\n    " : " ",
                            correction.growth[i]);
    }
    result += "]\n";
  }
  return result;
}

}  // namespace hmcdyn::slam

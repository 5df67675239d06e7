// SPDX-License-Identifier: BSD-3-Clause
#include "calibrate/true_error.hpp"

#include <cmath>
#include <stdexcept>

#include <yaml-cpp/yaml.h>

namespace hmcdyn::calibrate {
namespace {

double rmsOf(const std::vector<double>& values, double without) {
  double sum = 0.0;
  for (const double value : values) {
    sum += (value - without) * (value - without);
  }
  return std::sqrt(sum / static_cast<double>(values.size()));
}

double meanOf(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) {
    sum += value;
  }
  return sum / static_cast<double>(values.size());
}

}  // namespace

TrueError readTrueError(const std::filesystem::path& file) {
  try {
    const YAML::Node root = YAML::LoadFile(file.string());
    TrueError error;
    error.scale = root["scale_error"].as<double>();
    error.shift = {root["registration_shift"][0].as<double>(),
                   root["registration_shift"][1].as<double>()};
    const YAML::Node grid = root["quadratic_error"];
    error.quadratic.rows = grid["rows"].as<int>();
    error.quadratic.columns = grid["columns"].as<int>();
    error.quadratic.growth = grid["values"].as<std::vector<double>>();
    slam::checkCorrection(error.quadratic);
    return error;
  } catch (const std::exception& error) {
    throw std::runtime_error(file.string() + ": " + error.what());
  }
}

Recovery recovery(const TrueError& error, const std::vector<DepthSample>& samples,
                  const CorrectionFit& fit, bool scale_known, cv::Size image) {
  if (samples.empty()) {
    return {};
  }
  std::vector<double> before;
  std::vector<double> after;
  for (const DepthSample& s : samples) {
    const double z = s.truth;
    const double measured =
        z * (1.0 + error.scale + slam::growthAt(error.quadratic, s.u, s.v, image) * z);
    before.push_back(measured / z - 1.0);
    after.push_back(corrected(fit.correction, measured, s.u, s.v, image) / z - 1.0);
  }
  return {rmsOf(before, scale_known ? 0.0 : meanOf(before)),
          rmsOf(after, scale_known ? 0.0 : meanOf(after))};
}

}  // namespace hmcdyn::calibrate

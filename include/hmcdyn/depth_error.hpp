// SPDX-License-Identifier: BSD-3-Clause
// How far a depth camera's depths are wrong: what changes from frame to frame, and what does not.
#pragma once

#include <cmath>
#include <stdexcept>
#include <string>

#include <hmcdyn/detail/requirements.hpp>

namespace hmcdyn {

/// The error of a depth camera, in two parts. Its *noise* is drawn anew in each frame, so that many
/// frames average it out. Its *systematic* error (calibration, registration, distortion of the
/// depth image) changes slowly over image and range: neighbouring frames share it, and no number of
/// them takes it away. Both are standard deviations that grow with the depth z,
///   noise:      noise_floor + noise_quadratic z^2
///   systematic: systematic_linear z + systematic_quadratic z^2.
struct DepthErrorModel {
  float noise_floor = 0.001f;           ///< (m).
  float noise_quadratic = 1.425e-3f;    ///< (1/m); Kinect v1: Khoshelham and Elberink 2012.
  float systematic_linear = 0.0f;       ///< Share of the depth: a wrong scale.
  float systematic_quadratic = 0.010f;  ///< (1/m): a wrong disparity offset.
  /// Share of the systematic error that two views of one point do not have in common: it changes
  /// over the image and with the angle of view. Measured on a Kinect v1 as 0.25 over half a second,
  /// 0.4 over two.
  float unshared = 0.3f;
};

/// Standard deviation (m) of what changes from frame to frame, at a depth z > 0 (m).
template <class T>
T depthNoise(T z, const DepthErrorModel& model) {
  return static_cast<T>(model.noise_floor) + static_cast<T>(model.noise_quadratic) * z * z;
}

/// Standard deviation (m) of what neighbouring frames share, at a depth z > 0 (m).
template <class T>
T systematicDepthError(T z, const DepthErrorModel& model) {
  return static_cast<T>(model.systematic_linear) * z +
         static_cast<T>(model.systematic_quadratic) * z * z;
}

/// Standard deviation (m) of a depth z > 0 (m) against what other views of the same point measured:
/// what they share is left out.
/// @param together depths beside each other that are used together, >= 1. What is wrong with them
/// they share, too, so that all of them say of it what one would.
template <class T>
T relativeDepthError(T z, const DepthErrorModel& model, T together = T(1)) {
  using std::hypot;
  using std::sqrt;
  return hypot(depthNoise(z, model),
               sqrt(together) * static_cast<T>(model.unshared) * systematicDepthError(z, model));
}

/// Standard deviation (m) of a single depth z > 0 (m) against the truth.
template <class T>
T depthError(T z, const DepthErrorModel& model) {
  using std::hypot;
  return hypot(depthNoise(z, model), systematicDepthError(z, model));
}

/// @throws std::invalid_argument naming the first field that is negative or not finite, or a noise
/// that is 0 at every depth.
inline void checkModel(const DepthErrorModel& model) {
  const auto require = [](bool good, const char* field, float value, const char* expected) {
    if (!good) {
      throw std::invalid_argument(std::string("DepthErrorModel: ") + field + " is " +
                                  std::to_string(value) + "; expected " + expected);
    }
  };
  const auto valid = [](float value) { return std::isfinite(value) && value >= 0.0f; };
  require(valid(model.noise_floor), "noise_floor", model.noise_floor, "metres >= 0");
  require(valid(model.noise_quadratic), "noise_quadratic", model.noise_quadratic, "1/m >= 0");
  require(valid(model.systematic_linear), "systematic_linear", model.systematic_linear,
          "a share >= 0");
  require(valid(model.systematic_quadratic), "systematic_quadratic", model.systematic_quadratic,
          "1/m >= 0");
  require(valid(model.unshared) && model.unshared <= 1.0f, "unshared", model.unshared,
          "a share, 0..1");
  require(model.noise_floor + model.noise_quadratic > 0.0f, "noise_floor", model.noise_floor,
          "a noise above 0 here or in noise_quadratic");
}

}  // namespace hmcdyn

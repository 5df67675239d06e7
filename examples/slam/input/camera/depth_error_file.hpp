// SPDX-License-Identifier: BSD-3-Clause
// What a camera's file says of its depth: how wrong it is, and what of that can be taken out.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <hmcdyn/depth_error.hpp>

#include "slam/input/camera/depth_correction.hpp"
#include "slam/input/camera/settings_file.hpp"

namespace hmcdyn::slam {

/// How a camera measures depth.
enum class DepthSensor : std::uint8_t {
  kStructuredLight,  ///< "structured_light": Kinect v1, Xtion, Astra.
  kTimeOfFlight,     ///< "time_of_flight": Kinect v2, Azure Kinect.
  kActiveStereo,     ///< "active_stereo": RealSense D4xx.
};

/// "structured_light", "time_of_flight", "active_stereo".
std::vector<std::string> depthSensorNames();
const char* toString(DepthSensor sensor) noexcept;
std::optional<DepthSensor> findDepthSensor(const std::string& name);

/// The error of a camera of that kind that nobody has calibrated, from published figures:
/// - structured light: noise 1.425e-3 z^2 (Khoshelham and Elberink 2012), systematic 0.010 z^2,
///   which is our own figure (docs/calibration.md).
/// - time of flight: a standard deviation of up to 17 mm and a distance error below 11 mm, both up
///   to 3.5 m (Toelgyessy et al. 2021 for Azure Kinect): noise 0.001 m + 1.3e-3 z^2, which is 17 mm
///   at 3.5 m; 11 mm as a share of 2 m.
/// - active stereo: Intel's z^2 * subpixel / (focal length * baseline) with a subpixel of 0.08 px,
///   424 px and 50 mm (D435 at 848 x 480) is 3.8e-3 z^2 of noise; its accuracy of 2 % at 2 m (data
///   sheet of the D400 family), taken as two standard deviations, is 0.005 z^2.
DepthErrorModel defaultDepthError(DepthSensor sensor);

/// The part of a camera's file that is about depth.
struct DepthSettings {
  DepthSensor sensor = DepthSensor::kStructuredLight;
  DepthErrorModel error;
  DepthCorrection correction;
};

/// Reads three keys, all of them optional, whatever else the file says and in whichever spelling:
///
///   sensor: active_stereo     one of depthSensorNames(); default structured_light
///   depth_error:              DepthErrorModel's, after the correction; default the sensor's
///     noise_floor: 0.001
///     noise_quadratic: 0.0014
///     systematic_linear: 0
///     systematic_quadratic: 0.010
///   depth_correction:         DepthCorrection;                              default none
///     scale: 1.01
///     rows: 5
///     columns: 7
///     growth: [...]           rows x columns numbers (1/m)
///
/// @throws std::runtime_error that names file and key, and the line where there is one.
DepthSettings readDepthSettings(const SettingsFile& settings);

/// A camera file's text with these settings in place of those that it may have; all else stays as
/// it is, comments too.
/// @param origin lines that say where the settings come from, written as a comment before them.
std::string withDepthSettings(const std::string& text, const DepthSettings& settings,
                              const std::vector<std::string>& origin);

}  // namespace hmcdyn::slam

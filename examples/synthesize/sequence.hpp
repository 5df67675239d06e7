// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "synthesize/renderer.hpp"
#include "synthesize/sensor.hpp"

namespace hmcdyn::synthesize {

/// Everything that decides what is written.
struct SequenceOptions {
  std::string scene = "walking_xyz";  ///< A name of sceneCatalog().
  std::filesystem::path output;       ///< Folder to write.
  int frames = 300;                   ///< Number of frames.
  std::uint64_t seed = 1;             ///< Of everything random.
  NoiseModel noise = NoiseModel::kKinect;
  int width = 640;                   ///< (px)
  int height = 480;                  ///< (px)
  std::filesystem::path trajectory;  ///< TUM trajectory that replaces the scene's; may be empty.
  double exposure = 0.012;           ///< Of the Kinect models (s); 0 without noise.
  double moving_speed = 0.01;        ///< Faster surfaces are moving in mask/ (m/s).
  double box_drop = 0.0;             ///< Probability that a box is missing, 0..1.
  double box_jitter = 0.0;           ///< Standard deviation of a box's borders (px).
  int box_pixels = 150;              ///< Visible pixels at 640x480 that make a box.
  int threads = 0;                   ///< 0 = one a core; files do not depend on it.
  bool overwrite = false;            ///< Replace what is in a non-empty folder.
};

inline constexpr double kFrameRate = 30.0;           ///< (Hz)
inline constexpr double kFirstStamp = 1700000000.0;  ///< Time stamp of frame 0 (s).

/// What is wrong with the camera of NoiseModel::kKinectSystematic, as writeSystematicError() has
/// it.
inline constexpr const char* kSystematicErrorFile = "sensor.yaml";

/// TUM's freiburg3 camera, scaled to an image size.
PinholeCamera scaledCamera(int width, int height);

/// Renders a sequence into `options.output`, in the format of the TUM RGB-D benchmark.
/// @param progress called with the number of finished frames, from one thread at a time.
/// @throws std::invalid_argument for an option out of range, an unknown scene or a non-empty
///   folder; std::runtime_error when a file cannot be read or written.
void writeSequence(const SequenceOptions& options,
                   const std::function<void(std::size_t)>& progress = {});

}  // namespace hmcdyn::synthesize

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "synthesize/renderer.hpp"
#include "synthesize/systematic_error.hpp"

namespace hmcdyn::synthesize {

enum class NoiseModel {
  kNone,    ///< Truth, rounded to what the files can hold.
  kKinect,  ///< A structured-light RGB-D camera as used for the TUM data, perfectly calibrated.
  /// The same as it is delivered: its depth is wrong in every frame alike, and beside the colour.
  kKinectSystematic,
};

/// The Kinect model. Depth noise after Nguyen, Izadi and Lovell 2012 (axial and lateral), steps of
/// disparity after Khoshelham and Elberink 2012.
struct KinectOptions {
  double axial_base = 0.0012;         ///< Standard deviation at `axial_range` (m).
  double axial_growth = 0.0019;       ///< Its growth with the squared distance (1/m).
  double axial_range = 0.4;           ///< Range of the least noise (m).
  double lateral = 0.6;               ///< Standard deviation of where depth is read (px).
  double disparity_constant = 43.5;   ///< Infrared focal length times baseline (px m): 580 * 0.075.
  double disparity_step = 0.125;      ///< Resolution of the disparity (px).
  double min_depth = 0.5;             ///< Nearer surfaces have no depth (m).
  double max_depth = 5.0;             ///< Farther surfaces have no depth (m).
  double min_facing = 0.17;           ///< More grazing surfaces have no depth (cosine, 0..1).
  double dark = 16.0;                 ///< Surfaces as dark as this lose half their depth (0..255).
  double read_noise = 1.1;            ///< Standard deviation of colour without light (0..255).
  double shot_noise = 0.025;          ///< Variance of colour a grey level.
  double blur = 0.55;                 ///< Standard deviation of the optics' blur (px).
  double vignetting = 0.12;           ///< Loss of light in the corners (0..1).
  double exposure_swing = 0.07;       ///< Amplitude of the automatic exposure's drift (0..1).
  SystematicErrorOptions systematic;  ///< Of kKinectSystematic alone.
};

/// A frame as the camera delivers it.
struct SensorFrame {
  cv::Mat color;  ///< 8-bit BGR.
  cv::Mat depth;  ///< 16-bit, 1/5000 m; 0 = none.
};

inline constexpr double kDepthFactor = 5000.0;

/// Turns truth into measurements. Stateless between frames, safe to share between threads.
class Sensor {
 public:
  Sensor(NoiseModel model, const KinectOptions& options, cv::Size size, std::uint64_t seed);

  /// @param index number of the frame, which seeds its noise; @param time (s), for the exposure.
  SensorFrame measure(const RenderedFrame& frame, std::uint64_t index, double time) const;

  /// What is wrong in every frame alike; nothing except for kKinectSystematic.
  const SystematicError& systematicError() const noexcept { return systematic_; }

 private:
  cv::Mat measureColor(const cv::Mat& color, std::uint64_t index, double time) const;
  cv::Mat measureDepth(const RenderedFrame& frame, std::uint64_t index) const;
  cv::Mat shadowOf(const cv::Mat& depth) const;

  NoiseModel model_;
  KinectOptions options_;
  std::uint64_t seed_;
  std::vector<float> normals_;  // standard normal numbers; a power of two of them
  cv::Mat vignette_;            // 16-bit, 256 = full light
  SystematicError systematic_;
};

}  // namespace hmcdyn::synthesize

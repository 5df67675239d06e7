// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include <hmcdyn/types.hpp>

#include "synthesize/rasterizer.hpp"
#include "synthesize/scene.hpp"

namespace hmcdyn::synthesize {

struct RenderOptions {
  int width = 640;                                   ///< (px)
  int height = 480;                                  ///< (px)
  PinholeCamera camera{535.4, 539.2, 320.1, 247.6};  ///< Pixel (0, 0) is a pixel's centre.
  double exposure = 0.0;       ///< Time the shutter is open (s), around the frame's time.
  double moving_speed = 0.01;  ///< What is faster relative to the world is moving (m/s).
};

/// Values of `mask/` pictures.
inline constexpr std::uint8_t kMaskStatic = 0;  ///< The room.
inline constexpr std::uint8_t kMaskStanding =
    128;                                          ///< A person, or a thing that can move, at rest.
inline constexpr std::uint8_t kMaskMoving = 255;  ///< Faster than RenderOptions::moving_speed.

/// What the scene is at the middle of the exposure, free of noise. All maps are of the image's
/// size and hold for the ray through the pixel's centre; only the colour is integrated over the
/// pixel's area and the exposure.
struct RenderedFrame {
  Eigen::Isometry3d camera_to_world = Eigen::Isometry3d::Identity();
  cv::Mat color;   ///< 8-bit BGR.
  cv::Mat depth;   ///< float, z in the camera's frame (m); 0 = nothing met.
  cv::Mat facing;  ///< float, cosine between the ray and the surface's normal, 0..1.
  cv::Mat mask;    ///< 8-bit, kMask values.
  cv::Mat mover;   ///< 16-bit signed, number of the mover; -1 = the room.
};

/// Renders frames of one scene. Holds scratch memory: one renderer a thread.
class Renderer {
 public:
  /// @param scene borrowed, with painted textures.
  /// @throws std::invalid_argument unless the size and the focal lengths are positive, the
  ///   exposure and the speed not negative.
  Renderer(const Scene& scene, const RenderOptions& options);

  /// @param time (s); the same time gives the same frame.
  RenderedFrame render(double time);

 private:
  std::vector<Instance> instancesAt(double time,
                                    const std::vector<std::vector<float>>& light) const;
  void accumulateColor(double dither);
  void fillMaps(double time, const std::vector<Instance>& instances, RenderedFrame& frame) const;

  const Scene& scene_;
  RenderOptions options_;
  Rasterizer rasterizer_;
  std::vector<std::uint16_t> sums_;  // of the colour samples, BGR
};

}  // namespace hmcdyn::synthesize

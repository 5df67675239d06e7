// SPDX-License-Identifier: BSD-3-Clause
// A frame at working size, laid out for random access by later frames.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

#include <hmcdyn/motion_mask.hpp>

namespace hmcdyn::internal {

/// What a later frame asks about a pixel and its 8 neighbours.
struct MaskCell {
  float nearest = 0.0f;   ///< Depth (m); 0 = too few depths around to speak of free space.
  float farthest = 0.0f;  ///< Depth (m); 0 = none.
  float belief = 0.0f;    ///< -1 .. 1.
  std::uint8_t darkest = 0;
  std::uint8_t brightest = 255;
  std::int16_t thing = 0;  ///< Number of the thing, 0 = none.
};

constexpr float kNoNearest = 1e5f;  // (m): MaskCell::nearest is more where nothing was measured

struct SmallFrame {
  double timestamp = 0.0;
  Pose camera_from_world;
  int width = 0;
  int height = 0;
  std::vector<float> depth;        ///< (m), 0 = none.
  std::vector<std::uint8_t> gray;  ///< Empty without a gray image.
  float brightness = 0.0f;         ///< Mean of it.
  std::vector<MaskCell> cells;
  float depth_share = 0.0f;  ///< Of its pixels.

  std::size_t size() const { return depth.size(); }
  std::size_t index(int row, int column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(column);
  }
};

/// Pinhole camera of the reduced image.
struct SmallCamera {
  float fx = 0.0f;
  float fy = 0.0f;
  float cx = 0.0f;
  float cy = 0.0f;
};

/// Pixels of the whole image a side of a reduced pixel.
int reductionOf(int image_width, int working_width);

/// A reduced pixel's depth is the one of the whole image's pixel in its middle.
SmallCamera smallCamera(const PinholeCamera& camera, int reduction);

/// Fills a frame. @param reuse its memory is taken over.
/// @param scratch of the reduced image; reused.
SmallFrame reduceFrame(const MotionMaskFrame& frame, int reduction, SmallFrame reuse,
                       std::vector<MaskCell>& scratch);

/// Rotation (row by row) and translation that take points of one camera's frame to another's.
struct RelativePose {
  std::array<float, 9> rotation;
  std::array<float, 3> translation;
};

/// Of two cameras, each as camera_from_world. @return earlier_from_current.
RelativePose relativePose(const Pose& earlier, const Pose& current);

/// Where a pixel's surface is in another frame if it is static: reduced pixels and depth (m).
struct StaticPlace {
  float u = -1.0f;
  float v = -1.0f;
  float depth = 0.0f;
};
/// @param z depth of the pixel (m). @param motion takes points of its camera to the other's.
inline StaticPlace staticPlace(int row, int column, float z, const SmallCamera& camera,
                               const RelativePose& motion) {
  constexpr float kNearest = 0.1f;  // (m)
  const float x = (static_cast<float>(column) - camera.cx) / camera.fx * z;
  const float y = (static_cast<float>(row) - camera.cy) / camera.fy * z;
  const auto& r = motion.rotation;
  const auto& t = motion.translation;
  const float depth = r[6] * x + r[7] * y + r[8] * z + t[2];
  if (!(z > 0.0f) || depth < kNearest) {
    return {};
  }
  return {camera.fx * (r[0] * x + r[1] * y + r[2] * z + t[0]) / depth + camera.cx + 0.5f,
          camera.fy * (r[3] * x + r[4] * y + r[5] * z + t[1]) / depth + camera.cy + 0.5f, depth};
}
/// The same of a pixel by its number.
StaticPlace staticPlace(std::uint32_t pixel, const SmallFrame& frame, const SmallCamera& camera,
                        const RelativePose& motion);

/// True where all numbers are finite.
bool isFinite(const Pose& pose);

/// Distance (m) and angle (rad) between two cameras.
struct PoseStep {
  double distance = 0.0;
  double angle = 0.0;
};
PoseStep stepBetween(const Pose& earlier, const Pose& current);

}  // namespace hmcdyn::internal

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

/// A reduced pixel stands for the whole image's pixel in its middle.
SmallCamera smallCamera(const PinholeCamera& camera, int reduction);

/// Buffers of reduceFrame().
struct ReduceWorkspace {
  // Of each column of a row of squares:
  std::vector<float> middles;       ///< Depth in the middle of the square.
  std::vector<float> depth_sums;    ///< Of depths like it.
  std::vector<float> depth_counts;  ///< Of depths like it.
  std::vector<std::uint32_t> sums;  ///< Of gray levels.
  // Of three reduced pixels above each other, a column at each border added:
  std::vector<float> nearest;
  std::vector<float> farthest;
  std::vector<int> measured;
  std::vector<std::uint8_t> darkest;
  std::vector<std::uint8_t> brightest;
};

/// Fills a frame. @param reuse its memory is taken over.
SmallFrame reduceFrame(const MotionMaskFrame& frame, int reduction, SmallFrame reuse,
                       ReduceWorkspace& workspace);

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
constexpr float kNearestPlace = 0.1f;  // (m): no depth camera measures nearer

/// @param ray_x, ray_y of the pixel, at z = 1. @param z its depth (m). @param motion takes points
/// of its camera to the other's. Means nothing where z or the depth there is too small.
inline StaticPlace placeOnRay(float ray_x, float ray_y, float z, const SmallCamera& camera,
                              const RelativePose& motion) {
  const float x = ray_x * z;
  const float y = ray_y * z;
  const auto& r = motion.rotation;
  const auto& t = motion.translation;
  const float depth = r[6] * x + r[7] * y + r[8] * z + t[2];
  return {camera.fx * (r[0] * x + r[1] * y + r[2] * z + t[0]) / depth + camera.cx + 0.5f,
          camera.fy * (r[3] * x + r[4] * y + r[5] * z + t[1]) / depth + camera.cy + 0.5f, depth};
}
/// True where all are. All are evaluated: a loop has no branch then, and the compiler takes several
/// pixels at a time.
template <typename... Flags>
constexpr bool allOf(Flags... flags) {
  return (static_cast<unsigned>(flags) & ...) != 0U;
}

/// Number of the pixel that (u, v) lies in; -1 outside the image, or where none is wanted.
inline std::int32_t pixelAround(float u, float v, bool wanted, int width, int height) {
  const bool inside = allOf(wanted, u >= 0.0f, v >= 0.0f, u < static_cast<float>(width),
                            v < static_cast<float>(height));
  const auto column = static_cast<std::int32_t>(inside ? u : 0.0f);
  const auto row = static_cast<std::int32_t>(inside ? v : 0.0f);
  return inside ? row * width + column : -1;
}

/// Where the surface of a pixel is, by its number; u and v are -1 where it has no place.
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

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Core>

#include <hmcdyn/detail/requirements.hpp>
#include <hmcdyn/span.hpp>

/// Which key points of a frame lie on moving things: one header a step, in the order in which a
/// frame's data flows (hmcdyn.hpp names them in that order).
namespace hmcdyn {

/// What a quantity is where it was not measured: an epipolar distance without a match, for one.
inline constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// True where a depth can be used: finite and positive (m). 0, negative and NaN mean "none".
inline bool hasDepth(float depth) noexcept { return depth > 0.0f && std::isfinite(depth); }

/// A frame's key points, structure of arrays, borrowed from the caller. All of one size.
struct KeyPointsView {
  Span<const float> u;      ///< Columns (px), of the undistorted image.
  Span<const float> v;      ///< Rows (px), of the undistorted image.
  Span<const float> depth;  ///< Depths (m); 0, negative or NaN = none.

  /// N, the number of key points.
  std::size_t size() const noexcept { return u.size(); }
};

/// A frame's key points, structure of arrays, owned.
struct KeyPoints {
  std::vector<float> u;      ///< Columns (px), of the undistorted image.
  std::vector<float> v;      ///< Rows (px), of the undistorted image.
  std::vector<float> depth;  ///< Depths (m); 0, negative or NaN = none.

  /// N, the number of key points.
  std::size_t size() const noexcept { return u.size(); }
  /// Memory for n key points.
  void reserve(std::size_t n) {
    u.reserve(n);
    v.reserve(n);
    depth.reserve(n);
  }
  /// Appends a key point: pixel (px) and depth (m).
  // NOLINTNEXTLINE(readability-identifier-naming): as the standard containers say it
  void push_back(float column, float row, float metres) {
    u.push_back(column);
    v.push_back(row);
    depth.push_back(metres);
  }
  /// A view of the three arrays; valid until one of them is resized.
  KeyPointsView view() const noexcept { return {u, v, depth}; }
};

/// Checks the sizes.
/// @throws std::invalid_argument unless the three arrays have one size.
inline void checkKeyPoints(const KeyPointsView& points) {
  if (points.v.size() != points.u.size() || points.depth.size() != points.u.size()) {
    throw std::invalid_argument("key points: u has " + std::to_string(points.u.size()) +
                                " elements, v " + std::to_string(points.v.size()) + ", depth " +
                                std::to_string(points.depth.size()) + "; expected equal sizes");
  }
}

/// COCO's class number of "person", which every detector here speaks.
inline constexpr int kPersonClassId = 0;

/// What a detector found: an axis-aligned box in pixels, borders included. A box with a NaN, or
/// with a maximum below its minimum, holds no point; a box may reach outside the image.
struct DetectionBox {
  float x_min = 0.0f;             ///< Left border (px).
  float y_min = 0.0f;             ///< Upper border (px).
  float x_max = 0.0f;             ///< Right border (px).
  float y_max = 0.0f;             ///< Lower border (px).
  int class_id = kPersonClassId;  ///< COCO class, 0 = person.
  float score = 1.0f;             ///< Confidence, 0..1.

  /// True on the borders, too; false for NaN.
  bool contains(float u, float v) const noexcept {
    return u >= x_min && u <= x_max && v >= y_min && v <= y_max;
  }
};

/// Pinhole camera without distortion.
struct PinholeCamera {
  double fx = 0.0;  ///< Focal length, columns (px).
  double fy = 0.0;  ///< Focal length, rows (px).
  double cx = 0.0;  ///< Principal point, column (px).
  double cy = 0.0;  ///< Principal point, row (px).

  /// Pixel of a point in the camera's frame (m). The point must have z != 0.
  Eigen::Vector2d project(const Eigen::Vector3d& point) const {
    return {fx * point.x() / point.z() + cx, fy * point.y() / point.z() + cy};
  }
  /// Point in the camera's frame (m) of a pixel at a depth (m).
  Eigen::Vector3d unproject(double u, double v, double depth) const {
    return {(u - cx) / fx * depth, (v - cy) / fy * depth, depth};
  }
};

/// What earlier frames have shown of a point.
enum class KnownMotion : std::uint8_t {
  kAtRest,   ///< It was at rest, with some certainty.
  kUnknown,  ///< Too little: it has just appeared, or nothing was measured near it.
  kMoving,   ///< It moved.
};

/// The verdict on a key point.
enum class PointLabel : std::uint8_t {
  kStatic,     ///< Outside every dynamic box: full weight.
  kSuspect,    ///< In a dynamic box and kept, with the weight of eq. 7.
  kDynamic,    ///< On a moving thing: weight 0.
  kUnmatched,  ///< In a dynamic box, without a distance, and not placed by its depth either.
};

/// "static", "suspect", "dynamic" or "unmatched".
inline const char* toString(PointLabel label) noexcept {
  switch (label) {
    case PointLabel::kStatic:
      return "static";
    case PointLabel::kSuspect:
      return "suspect";
    case PointLabel::kDynamic:
      return "dynamic";
    case PointLabel::kUnmatched:
      return "unmatched";
  }
  return "invalid";
}

}  // namespace hmcdyn

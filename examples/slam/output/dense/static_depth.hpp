// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include <hmcdyn/types.hpp>

namespace hmcdyn::slam {

struct StaticDepthOptions {
  int stride = 2;             ///< Every so many pixels are kept, in both directions. Above 0.
  float min_depth = 0.3f;     ///< Nearer ones are left out (m). Above 0.
  float max_depth = 4.0f;     ///< Farther ones see too coarsely (m). Up to 32.
  float box_margin = 12.0f;   ///< Boxes are that much larger on each side (px). At least 0.
  float point_radius = 8.0f;  ///< Around dynamic key points, that much is left out (px).
  /// A pixel at a jump of depth above this share of its depth, from a neighbour two pixels away, is
  /// left out: it lies on neither of the two surfaces. Above 0.
  float edge_share = 0.05f;
  /// In the box of a thing that moves or may move, only what is farther than the thing by more than
  /// this (m) is the room's: arms and legs that the motion mask missed are not. At least 0.
  float room_behind = 0.5f;
};

/// What the dense map needs of a key frame: thinned out, some 0.4 MB at 640x480.
struct ThinnedKeyFrame {
  int stride = 1;  ///< Pixel (r, c) here was pixel (r * stride, c * stride).
  cv::Mat depth;   ///< CV_16UC1 (mm), 0 = none, of everything, moving or not: for looking through.
  cv::Mat usable;  ///< CV_8UC1, 255 = on a static surface; only these make points.
  cv::Mat colour;  ///< CV_8UC3, BGR.
};

/// Where nothing moves: 255, and 0 inside the boxes with their margin and around the points. A box
/// or a point with a NaN, and inverted boxes, cover nothing.
/// @param boxes of people, moving or not, and of other things that move.
/// @throws std::invalid_argument on a size without pixels or an option out of range.
cv::Mat staticMask(cv::Size size, Span<const DetectionBox> boxes,
                   Span<const cv::Point2f> dynamic_points, const StaticDepthOptions& options = {});

/// staticMask() with a motion mask in place of whole boxes: 0 on what moves or may move (kMoving,
/// kStanding) and box_margin (px) around it, inside the boxes with their margin on what does not
/// lie behind that (room_behind), and around the points. A box in which the mask names nothing is
/// left out as a whole.
/// @param motion CV_8UC1, values of MaskLabel. @param depth CV_32FC1 (m), 0, negative or NaN =
/// none, of the same size. @throws std::invalid_argument on other types, different sizes, no
/// pixels, or an option out of range.
cv::Mat staticMaskByMotion(const cv::Mat& motion, const cv::Mat& depth,
                           Span<const DetectionBox> boxes, Span<const cv::Point2f> dynamic_points,
                           const StaticDepthOptions& options = {});

/// The mask without the pixels that have a label, and box_margin (px) around them.
/// @param mask CV_8UC1. @param labels any type of one channel, 0 = background, of the mask's size.
/// @throws std::invalid_argument on other types, different sizes, or an option out of range.
cv::Mat withoutLabels(const cv::Mat& mask, const cv::Mat& labels,
                      const StaticDepthOptions& options = {});

/// Boxes for staticMask(): persons, moving or not, and whatever else the filter found to move.
/// @param box_is_dynamic one a box. @throws std::invalid_argument where the sizes differ.
std::vector<DetectionBox> boxesToLeaveOut(Span<const DetectionBox> boxes,
                                          Span<const std::uint8_t> box_is_dynamic);

/// Thins out a key frame. Depths out of range, at jumps and under the mask are not usable.
/// @param bgr CV_8UC3. @param depth CV_32FC1 (m), 0, negative or NaN = none. @param mask CV_8UC1, 0
/// = leave out; empty = use all. All of one size.
/// @throws std::invalid_argument on other types, different sizes, or an option out of range.
ThinnedKeyFrame thinKeyFrame(const cv::Mat& bgr, const cv::Mat& depth, const cv::Mat& mask,
                             const StaticDepthOptions& options = {});

}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include <opencv2/core.hpp>

#include <hmcdyn/types.hpp>

namespace hmcdyn::slam {

/// A frame's labels, for drawing. Arrays borrowed.
struct Annotation {
  KeyPointsView points;                      ///< N key points.
  Span<const PointLabel> label;              ///< N verdicts.
  Span<const int> cluster;                   ///< N clusters, -1 = none.
  Span<const DetectionBox> boxes;            ///< M boxes.
  Span<const std::uint8_t> box_is_dynamic;   ///< M flags.
  std::string status;                        ///< One line at the lower border.
};

/// The picture of a frame: boxes (dynamic red, others green, with class and score), key points
/// (static green, suspect yellow, dynamic red, unmatched blue), a ring around each clustered point in
/// its cluster's colour, a legend and a status line.
/// @param bgr CV_8UC3, not changed.
/// @throws std::invalid_argument for an image of another type, or arrays of unequal size.
cv::Mat annotateFrame(const cv::Mat& bgr, const Annotation& annotation);

}  // namespace hmcdyn::slam

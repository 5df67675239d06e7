// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include <hmcdyn/types.hpp>

namespace hmcdyn::slam {

/// What the picture says besides the counts.
struct AnnotationText {
  std::size_t frame = 0;                 ///< Number of the frame.
  std::string model;                     ///< Motion model used, e.g. "fundamental"; "" = none.
  std::vector<std::string> class_names;  ///< By class id; "class 7" for one that has no name here.
};

/// Rows below the picture: a status line, and a legend with the counts by label (px).
inline constexpr int kAnnotationRows = 44;

/// The picture of a frame, kAnnotationRows higher than the image. Boxes: dynamic red, others green,
/// with class and score. Key points: static a green dot, suspect a yellow square, dynamic a red
/// cross, unmatched a blue-grey dot; those in a cluster with a ring in the cluster's colour. Points
/// and boxes with a NaN, and inverted boxes, are left out.
/// @param bgr CV_8UC3, not changed.
/// @param labels, clusters one a point; cluster -1 = none. @param box_is_dynamic one a box.
/// @throws std::invalid_argument on an empty image or another type, or where sizes differ.
cv::Mat annotateFrame(const cv::Mat& bgr, KeyPointsView points, Span<const PointLabel> labels,
                      Span<const int> clusters, Span<const DetectionBox> boxes,
                      Span<const std::uint8_t> box_is_dynamic, const AnnotationText& text);

}  // namespace hmcdyn::slam

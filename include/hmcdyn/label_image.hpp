// SPDX-License-Identifier: BSD-3-Clause
// What may move in a frame, as one value; masks as OpenCV holds them, for regions.hpp. [OpenCV]
#pragma once

#include <utility>
#include <vector>

#include <opencv2/core/mat.hpp>

#include <hmcdyn/detail/requirements.hpp>
#include <hmcdyn/regions.hpp>
#include <hmcdyn/span.hpp>
#include <hmcdyn/types.hpp>

namespace hmcdyn {

/// What may move in a frame: a detector's boxes, or a label a pixel and which of the labels may.
/// Borrowed for a call; the label image is shared, not copied. Empty = nothing is named.
struct Regions {
  Regions() = default;
  // Implicit on purpose: boxes are regions.
  // NOLINTBEGIN(google-explicit-constructor)
  Regions(Span<const DetectionBox> of_boxes) : boxes(of_boxes) {}          ///< Boxes.
  Regions(const std::vector<DetectionBox>& of_boxes) : boxes(of_boxes) {}  ///< Boxes.
  // NOLINTEND(google-explicit-constructor)
  /// A mask: the background in a person's box is none of it.
  Regions(cv::Mat label_image, Span<const LabelRegion> which)
      : labels(std::move(label_image)), labelled(which) {}

  Span<const DetectionBox> boxes = {};  ///< Of things that may move; with a mask none.
  cv::Mat labels = {};  ///< CV_8UC1, CV_16UC1 or CV_32SC1, of the image's size; empty = boxes.
  Span<const LabelRegion> labelled = {};  ///< Labels without one are background.

  /// Regions are those of a mask.
  bool byMask() const noexcept { return !labels.empty(); }
};

/// Every label of the image but the background's, in rising order, as regions of one class: for an
/// instance segmentation that shows one class only.
/// @param labels CV_8UC1, CV_16UC1 or CV_32SC1.
/// @throws std::invalid_argument for an empty image or one of another type.
std::vector<LabelRegion> regionsIn(const cv::Mat& labels, int background = 0,
                                   int class_id = kPersonClassId);

/// regionsOfPoints for an image of OpenCV.
/// @param labels CV_8UC1, CV_16UC1 or CV_32SC1.
/// @throws std::invalid_argument for an empty image or one of another type, or unequal arrays.
std::vector<int> regionsOfPoints(const KeyPointsView& points, const cv::Mat& labels,
                                 Span<const LabelRegion> regions);

/// boundingBoxes for an image of OpenCV.
/// @param labels CV_8UC1, CV_16UC1 or CV_32SC1.
/// @throws std::invalid_argument for an empty image or one of another type.
std::vector<DetectionBox> boundingBoxes(const cv::Mat& labels, Span<const LabelRegion> regions);

}  // namespace hmcdyn

// SPDX-License-Identifier: BSD-3-Clause
// Masks as OpenCV holds them, for regions.hpp. [OpenCV]
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include <hmcdyn/detail/requirements.hpp>
#include <hmcdyn/regions.hpp>

namespace hmcdyn {

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

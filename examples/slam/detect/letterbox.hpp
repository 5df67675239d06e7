// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include <hmcdyn/types.hpp>

namespace hmcdyn::slam {

/// How an image lies in a square network input: shrunk or enlarged to fit, centred, the rest grey.
/// Coordinates are continuous, 0 at the image's left or upper border, as YOLO's boxes have them.
struct Letterbox {
  cv::Size image;        ///< The image (px).
  cv::Size scaled;       ///< The image within the input (px): both sides by one factor, rounded.
  cv::Point offset;      ///< Upper left corner of the scaled image in the input (px).
  int input_size = 640;  ///< Side of the input (px).
};

/// @throws std::invalid_argument where the image or the input has no pixel.
Letterbox makeLetterbox(cv::Size image, int input_size);

/// The network's input (CV_8UC3, input_size x input_size) of an image (CV_8UC3).
cv::Mat toInput(const cv::Mat& bgr, const Letterbox& letterbox);

/// A box of the image as a box of the input (px).
DetectionBox toInput(const DetectionBox& box, const Letterbox& letterbox);

/// A box of the input as a box of the image (px): the inverse of toInput().
DetectionBox toImage(const DetectionBox& box, const Letterbox& letterbox);

}  // namespace hmcdyn::slam

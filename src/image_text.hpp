// SPDX-License-Identifier: BSD-3-Clause
// How messages name an image.
#pragma once

#include <string>

#include <opencv2/core.hpp>

namespace hmcdyn::internal {

/// "640 x 480 px, CV_16UC1"; "empty" where it has no pixel.
inline std::string imageText(const cv::Mat& image) {
  return image.empty() ? std::string("empty")
                       : std::to_string(image.cols) + " x " + std::to_string(image.rows) + " px, " +
                             cv::typeToString(image.type());
}

}  // namespace hmcdyn::internal

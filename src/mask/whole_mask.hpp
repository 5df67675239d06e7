// SPDX-License-Identifier: BSD-3-Clause
// From labels of reduced pixels to labels of the whole image.
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "mask/small_frame.hpp"

namespace hmcdyn::internal {

/// Labels for the pixels without depth: those between two parts of one thing, and the band without
/// depth at the image's border, which registration of depth and colour leaves; else kUnknown.
/// @param label of each pixel; changed where depth is missing. @param before reused.
void labelHoles(const SmallFrame& frame, std::vector<std::uint8_t>& label,
                std::vector<std::uint8_t>& before);

/// Each pixel of the whole image gets the label of the reduced pixel around it that is most like it
/// in depth. @param uniform reused. @param mask CV_8UC1 of the depth's size; written.
void labelWholeImage(const cv::Mat& depth, const SmallFrame& frame, int reduction,
                     const std::vector<std::uint8_t>& label, std::vector<std::uint8_t>& uniform,
                     cv::Mat& mask);

}  // namespace hmcdyn::internal

// SPDX-License-Identifier: BSD-3-Clause
// Which network a file holds that is none of those that are decoded here.
#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace hmcdyn::slam {

/// What the outputs of a network look like by their shapes, and what to export in its place: "1 x
/// 300 x 6: boxes after suppression, as YOLOv10 exports them; export ...".
std::string guessOfHead(const std::vector<cv::Mat>& outputs);

/// What is wrong with the values of an output whose shape is that of a YOLOv5 or YOLOv8 head: boxes
/// of candidates cover the input's pixels whatever the image shows, so values near 0, negative
/// sizes or scores outside 0..1 are those of a head that is not decoded. Empty where nothing is, or
/// the candidates are too few to tell.
/// @param output 1 x N x 85 or 1 x 84 x N, CV_32F. @param input_size side of the input (px).
std::string whatIsWrongWithHead(const cv::Mat& output, int input_size);

}  // namespace hmcdyn::slam

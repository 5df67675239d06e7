// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include <hmcdyn/types.hpp>

namespace hmcdyn::slam {

/// How the output of a YOLO network trained on COCO is laid out.
enum class YoloHead {
  kYoloV5,  ///< 1 x N x 85: a row a candidate, cx cy w h objectness and 80 classes.
  kYoloV8,  ///< 1 x 84 x N: a column a candidate, cx cy w h and 80 classes.
};

/// The layout by the output's shape; N = 25200 or 8400 at 640 x 640.
/// @throws std::invalid_argument that names the shape where it is neither, or not CV_32F.
YoloHead yoloHeadOf(const cv::Mat& output);

/// The candidates whose score reaches the threshold, in pixels of the network's input, before
/// non-maximum suppression. The class is the one with the largest probability, the score that
/// times the objectness. Candidates with a NaN or without area are left out.
/// @param output 1 x N x 85, CV_32F.
/// @throws std::invalid_argument where it is not.
std::vector<DetectionBox> decodeYoloV5(const cv::Mat& output, float score_threshold);

/// As decodeYoloV5(), without an objectness: the score is the largest probability.
/// @param output 1 x 84 x N, CV_32F.
std::vector<DetectionBox> decodeYoloV8(const cv::Mat& output, float score_threshold);

/// As decodeYoloV5() for the output of a Darknet [yolo] layer run by OpenCV: coordinates are
/// shares of the input's size, and the probabilities have the objectness in them.
/// @param output N x 85, CV_32F.
/// @param image size of the image (px), to whose pixels the boxes are scaled.
std::vector<DetectionBox> decodeDarknet(const cv::Mat& output, cv::Size image,
                                        float score_threshold);

/// "1 x 25200 x 85", for messages.
std::string shapeOf(const cv::Mat& array);

}  // namespace hmcdyn::slam

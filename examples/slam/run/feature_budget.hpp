// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

#include <hmcdyn/motion_mask.hpp>

namespace hmcdyn::slam {

/// How many key points to extract so that about `base` of them lie outside the boxes, at most
/// max_factor times as many: with people on half of the image a perfect filter would otherwise
/// leave too few.
/// @throws std::invalid_argument unless base > 0 and max_factor >= 1.
int featureBudget(int base, double covered_share, double max_factor);

/// Where to look for corners in a frame, given the motion mask of the frame before: not on what
/// moves, once that is a fifth of the image. In a crowd the room is what little is left, and most
/// corners would go to people. Below a fifth the filter's votes gain more from points on people
/// than the tracker loses; what moves keeps a rim of some pixels, since it has moved on.
/// @param corners CV_8UC1, 0 = none; empty = everywhere. @return the same, or what is left of it.
cv::Mat cornersOfRoom(const cv::Mat& corners, const MotionMask& before);

}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include <hmcdyn/frame_filter.hpp>

extern double timestamp;
extern cv::Mat gray, depth;
extern std::vector<cv::KeyPoint> key_points;
extern std::vector<float> point_depth;
extern std::vector<hmcdyn::DetectionBox> boxes;

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include <hmcdyn/compact.hpp>
#include <hmcdyn/frame_filter.hpp>

extern std::vector<cv::KeyPoint> key_points;
extern std::vector<float> point_depth, right_u;
extern cv::Mat descriptors;
extern std::vector<hmcdyn::DetectionBox> boxes;
extern hmcdyn::FrameFilter filter;
extern hmcdyn::FrameInput input;

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include <hmcdyn/types.hpp>

extern cv::Mat earlier_gray, current_gray;
extern hmcdyn::KeyPoints key_points;
extern std::vector<hmcdyn::DetectionBox> boxes;

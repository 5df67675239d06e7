// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "integration/compaction.hpp"
#include "integration/frame_filter.hpp"

extern std::vector<cv::KeyPoint> key_points;
extern std::vector<float> point_depth, right_u, weight;
extern cv::Mat descriptors;
extern const hmcdyn::integration::FrameFilterResult result;

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include <hmcdyn/dynamic_feature_filter.hpp>
#include <hmcdyn/label_image.hpp>

extern cv::Mat earlier_gray, current_gray, labels;
extern hmcdyn::KeyPoints key_points;

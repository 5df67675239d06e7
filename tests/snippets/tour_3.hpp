// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include <hmcdyn/dynamic_feature_filter.hpp>

extern cv::Mat mask;
extern hmcdyn::DynamicFeatureFilterInput input;

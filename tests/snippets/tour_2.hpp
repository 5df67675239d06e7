// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>
#include <vector>

#include <opencv2/core.hpp>

#include <hmcdyn/dynamic_feature_filter.hpp>

extern cv::Mat gray, depth;
extern hmcdyn::KeyPoints key_points;
extern std::vector<hmcdyn::DetectionBox> boxes;
extern hmcdyn::FlowPyramid last_pyramid;
extern hmcdyn::MotionBelief last_belief;
extern hmcdyn::DynamicFeatureFilterOptions options;
extern hmcdyn::DynamicFeatureFilterWorkspace filter_workspace;

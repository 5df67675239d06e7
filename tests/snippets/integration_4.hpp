// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include <hmcdyn/frame_filter.hpp>

extern cv::Mat labels;
extern hmcdyn::FrameFilter filter;
extern hmcdyn::FrameInput input;

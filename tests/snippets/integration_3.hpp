// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include "integration/frame_filter.hpp"

extern cv::Mat labels;
extern hmcdyn::integration::FrameFilter filter;
extern hmcdyn::integration::FrameInput input;

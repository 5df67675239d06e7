// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include <hmcdyn/frame_filter.hpp>

extern cv::Mat camera_matrix, distortion, gray, depth;
extern cv::Size image_size;
extern std::vector<cv::KeyPoint> undistorted_key_points;
extern hmcdyn::FrameInput input;

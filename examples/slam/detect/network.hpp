// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/dnn/dnn.hpp>

namespace hmcdyn::slam {

/// The error of a model that cannot be used: names the file, the OpenCV version, OpenCV's reason
/// and what to do about it.
std::runtime_error modelError(const std::filesystem::path& model, const std::string& reason,
                              const std::string& advice);

/// The error of a model that OpenCV runs and whose outputs are not decoded here: names the file,
/// what it looks like and what to export.
std::runtime_error headError(const std::filesystem::path& model, const std::string& what);

/// The outputs of a network for an image (CV_8UC3), which is scaled to the input's size; red,
/// green and blue in 0..1. Runs on the CPU with OpenCV's own kernels.
std::vector<cv::Mat> runNetwork(cv::dnn::Net& net, const cv::Mat& bgr, cv::Size input);

/// Chooses the backend that runNetwork() promises.
void useCpu(cv::dnn::Net& net);

}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include <opencv2/core/mat.hpp>

namespace hmcdyn::slam {

// A frame's motion mask as files. A file is there complete or not at all; both functions throw
// std::runtime_error, naming the file and the reason, when they cannot write, and
// std::invalid_argument for images of other types than below or of unequal size.

/// FOLDER/STAMP.png of a frame: named by the time stamp of its colour image (s, six decimals), as
/// the mask/ folders of hmcdyn_synthesize are.
std::filesystem::path stampedImage(const std::filesystem::path& folder, double timestamp);

/// Writes the mask, 8 bit, with the values of MaskLabel.
/// @param folder must be there. @param label CV_8UC1.
void writeMask(const std::filesystem::path& folder, double timestamp, const cv::Mat& label);

/// Writes the depth where nothing moves and nothing stands that may move, 16 bit; 0 there, where
/// there is no depth, and where it is too large for 16 bit.
/// @param folder must be there. @param depth CV_32FC1 (m). @param label CV_8UC1, of its size.
/// @param depth_factor what 1 m is in the file. Above 0.
void writeStaticDepth(const std::filesystem::path& folder, double timestamp, const cv::Mat& depth,
                      const cv::Mat& label, double depth_factor);

}  // namespace hmcdyn::slam

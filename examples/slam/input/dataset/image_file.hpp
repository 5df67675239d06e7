// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include <opencv2/core.hpp>

namespace hmcdyn::slam {

/// An image with the channels and the bit depth of its file. Any format of cv::imdecode; of PNG,
/// whose decoder may hand out the upper part of a file that was cut off, every chunk must be there.
/// @throws std::runtime_error that names the file where it is missing, truncated or no image.
cv::Mat readImage(const std::filesystem::path& file);

}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <opencv2/core.hpp>

namespace hmcdyn::slam {

struct DescriptorMatcherOptions {
  int max_distance = 64;    ///< Descriptors farther apart do not match (bits of 256).
  float max_ratio = 0.85f;  ///< Best to second best distance, 0..1.
};

/// Two key points that look alike.
struct DescriptorMatch {
  int from = 0;
  int to = 0;
  int distance = 0;  ///< Bits of 256.
};

/// Pairs that are each other's nearest and clearly nearer than the second nearest, by `from`. Of
/// equally near ones none is clearly nearer.
/// @param from, to N x 32 and M x 32, CV_8U; either may be empty.
/// @throws std::invalid_argument on another type or width.
std::vector<DescriptorMatch> matchDescriptors(const cv::Mat& from, const cv::Mat& to,
                                              const DescriptorMatcherOptions& options = {});

}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include <hmcdyn/types.hpp>

namespace hmcdyn::slam {

/// Part of the image that boxes cover, 0..1; what several cover counts once.
double coveredShare(Span<const DetectionBox> boxes, const cv::Size& image);

/// How many key points to extract so that about `base` of them lie outside the boxes, at most
/// max_factor times as many: with people on half of the image a perfect filter would otherwise
/// leave too few.
/// @throws std::invalid_argument unless base > 0 and max_factor >= 1.
int featureBudget(int base, double covered_share, double max_factor);

}  // namespace hmcdyn::slam

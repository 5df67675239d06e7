// SPDX-License-Identifier: BSD-3-Clause
// What four numbers are that are no corners in the order x_min y_min x_max y_max.
#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "slam/detect/box_plausibility.hpp"

namespace hmcdyn::slam {

/// In which other order of four numbers all boxes fit the image, and what to do about it: corners
/// that are exchanged, in one axis or both, sizes, centres. Empty where in none.
std::string guessOfOrder(const std::vector<TimedBox>& boxes, cv::Size image);

/// What boxes are that are inverted and fit in no one order: corners that are not sorted, or
/// something else. Never empty.
std::string guessOfCorners(const std::vector<TimedBox>& boxes, cv::Size image);

}  // namespace hmcdyn::slam

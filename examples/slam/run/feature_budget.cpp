// SPDX-License-Identifier: BSD-3-Clause
#include "slam/run/feature_budget.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace hmcdyn::slam {

int featureBudget(int base, double covered_share, double max_factor) {
  if (base <= 0 || !(max_factor >= 1.0)) {
    throw std::invalid_argument("featureBudget: base is " + std::to_string(base) + ", max_factor " +
                                std::to_string(max_factor) +
                                "; expected a count > 0 and a factor >= 1");
  }
  const double outside = std::clamp(1.0 - covered_share, 1.0 / max_factor, 1.0);
  return static_cast<int>(std::lround(base / outside));
}

cv::Mat cornersOfRoom(const cv::Mat& corners, const MotionMask& before) {
  constexpr float kLeastShare = 0.2f;
  constexpr int kRim = 6;  // px that a thing moves from frame to frame
  if (before.moving_share < kLeastShare ||
      (!corners.empty() && corners.size() != before.label.size())) {
    return corners;
  }
  cv::Mat room;
  cv::erode(before.label == static_cast<int>(MaskLabel::kMoving), room,
            cv::getStructuringElement(cv::MORPH_RECT, cv::Size(2 * kRim + 1, 2 * kRim + 1)));
  cv::bitwise_not(room, room);
  if (!corners.empty()) {
    cv::bitwise_and(room, corners, room);
  }
  return room;
}

}  // namespace hmcdyn::slam

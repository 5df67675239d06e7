// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <stdexcept>
#include <string>

#include <hmcdyn/frame_filter.hpp>

#include "regions/frame_regions.hpp"

namespace hmcdyn {

double coveredShare(Span<const DetectionBox> boxes, const cv::Size& image) {
  return internal::shareCovered(boxes, image);
}

double featureFactor(Span<const DetectionBox> boxes, const cv::Size& image, double max_factor) {
  if (!(max_factor >= 1.0)) {
    throw std::invalid_argument("featureFactor: max_factor is " + std::to_string(max_factor) +
                                "; expected a factor >= 1");
  }
  return 1.0 / std::clamp(1.0 - coveredShare(boxes, image), 1.0 / max_factor, 1.0);
}

}  // namespace hmcdyn

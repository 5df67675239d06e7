// SPDX-License-Identifier: BSD-3-Clause
// Which key points get a distance: optical flow is the dearest step of the filter.
#pragma once

#include <cstddef>
#include <vector>

#include <opencv2/core/types.hpp>

#include <hmcdyn/types.hpp>

namespace hmcdyn::internal {

struct FlowBudget {
  float margin = 0.0f;  ///< Points so near a box belong to it (px).
  int in_boxes = 0;     ///< So many points in boxes, spread over the image; 0 = all.
  int background = 0;   ///< So many others; 0 = all.
};

/// The key points that get a distance, as arrays of their own.
struct FlowSelection {
  std::vector<std::size_t> source;  ///< Their numbers, ascending.
  KeyPoints points;
};

/// Points that are not finite are never chosen.
FlowSelection selectForFlow(const KeyPointsView& points, Span<const DetectionBox> boxes,
                            const cv::Size& image, const FlowBudget& budget);

}  // namespace hmcdyn::internal

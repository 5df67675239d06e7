// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include <hmcdyn/filter_stage.hpp>

#include "random.hpp"

namespace hmcdyn::test {

/// Key points, distances and boxes of a made-up frame.
struct Frame {
  KeyPoints points;
  std::vector<float> distance;
  std::vector<DetectionBox> boxes;

  FilterStageResult filter(const FilterStageOptions& options) const {
    return filterKeyPoints(points.view(), distance, boxes, options);
  }
};

/// Up to 400 key points at pixels that are multiples of 1/8, up to 5 boxes that may overlap, reach
/// outside the image or hold nothing. In a box, some points are a mover's: near, with a large
/// distance, a common depth. Some points have no depth, some no distance.
inline Frame makeFrame(Random& random) {
  Frame frame;
  const int boxes = random.integer(0, 5);
  for (int b = 0; b < boxes; ++b) {
    const float x = random.uniformFloat(-100.0, 600.0);
    const float y = random.uniformFloat(-100.0, 440.0);
    const float width = random.uniformFloat(-20.0, 350.0);
    const float height = random.uniformFloat(-20.0, 350.0);
    frame.boxes.push_back({x, y, x + width, y + height, random.chance(0.7) ? kPersonClassId : 56,
                           random.uniformFloat(0.3, 1.0)});
  }
  const int n = random.integer(0, 400);
  for (int i = 0; i < n; ++i) {
    const float u = static_cast<float>(random.integer(0, 640 * 8)) / 8.0f;
    const float v = static_cast<float>(random.integer(0, 480 * 8)) / 8.0f;
    std::size_t box = 0;
    while (box < frame.boxes.size() && !frame.boxes[box].contains(u, v)) {
      ++box;
    }
    const bool mover = box < frame.boxes.size() && random.chance(0.5);
    const double depth = mover ? 1.0 + 0.7 * static_cast<double>(box) + random.normal(0.05)
                               : random.uniform(2.5, 5.0);
    const double distance = mover ? random.uniform(0.5, 5.0) : random.uniform(0.0, 0.6);
    frame.points.push_back(u, v, random.chance(0.15) ? 0.0f : static_cast<float>(depth));
    frame.distance.push_back(random.chance(0.15) ? kNaN : static_cast<float>(distance));
  }
  return frame;
}

}  // namespace hmcdyn::test

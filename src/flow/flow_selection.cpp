// SPDX-License-Identifier: BSD-3-Clause
#include "flow/flow_selection.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

namespace hmcdyn::internal {
namespace {

constexpr std::size_t kCells = 12;  // a side of the grid that spreads points over the image

std::size_t cellOf(float u, float v, const cv::Size& image) {
  const auto cell = [](float x, int extent) {
    const float share = x / static_cast<float>(std::max(extent, 1));
    return static_cast<std::size_t>(
        std::clamp(share * static_cast<float>(kCells), 0.0f, static_cast<float>(kCells - 1)));
  };
  return cell(v, image.height) * kCells + cell(u, image.width);
}

/// Round by round one more of each cell, in the order of the points, until there are enough.
std::vector<std::size_t> spread(std::vector<std::size_t> candidates, std::size_t wanted,
                                const KeyPointsView& points, const cv::Size& image) {
  if (candidates.size() <= wanted) {
    return candidates;
  }
  std::vector<std::size_t> chosen;
  while (chosen.size() < wanted) {
    std::array<bool, kCells * kCells> taken{};
    std::vector<std::size_t> left;
    for (const std::size_t i : candidates) {
      bool& in_cell = taken[cellOf(points.u[i], points.v[i], image)];
      if (!in_cell && chosen.size() < wanted) {
        in_cell = true;
        chosen.push_back(i);
      } else {
        left.push_back(i);
      }
    }
    candidates = std::move(left);
  }
  return chosen;
}

bool inAnyBox(Span<const DetectionBox> boxes, float u, float v, float margin) {
  return std::any_of(boxes.begin(), boxes.end(), [&](const DetectionBox& box) {
    return u >= box.x_min - margin && u <= box.x_max + margin && v >= box.y_min - margin &&
           v <= box.y_max + margin;
  });
}

}  // namespace

FlowSelection selectForFlow(const KeyPointsView& points, Span<const DetectionBox> boxes,
                            const cv::Size& image, const FlowBudget& budget) {
  std::vector<std::size_t> in_boxes;
  std::vector<std::size_t> others;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (std::isfinite(points.u[i]) && std::isfinite(points.v[i])) {
      (inAnyBox(boxes, points.u[i], points.v[i], budget.margin) ? in_boxes : others).push_back(i);
    }
  }
  const auto limited = [&](std::vector<std::size_t> candidates, int wanted) {
    return wanted == 0
               ? candidates
               : spread(std::move(candidates), static_cast<std::size_t>(wanted), points, image);
  };
  FlowSelection selection;
  selection.source = limited(std::move(in_boxes), budget.in_boxes);
  const std::vector<std::size_t> background = limited(std::move(others), budget.background);
  selection.source.insert(selection.source.end(), background.begin(), background.end());
  std::sort(selection.source.begin(), selection.source.end());
  for (const std::size_t i : selection.source) {
    selection.points.push_back(points.u[i], points.v[i], points.depth[i]);
  }
  return selection;
}

}  // namespace hmcdyn::internal

// SPDX-License-Identifier: BSD-3-Clause
#include "mask/named.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

namespace hmcdyn::internal {
namespace {

constexpr float kMiddle = 0.25f;      // of a box's width, left out on both sides
constexpr float kQuantile = 0.3f;     // of the depths in the middle: a person, not what is behind
constexpr std::size_t kFewest = 20;   // depths that speak for a box
constexpr float kLeastShown = 0.15f;  // of the middle: less is the background around a nearer box
constexpr float kFarthest = 1e6f;     // (m)

struct PixelRange {
  int first_column;
  int last_column;
  int first_row;
  int last_row;
};

/// False for a box that is not finite or not in the image.
bool rangeOf(const DetectionBox& box, const SmallFrame& small, int reduction, PixelRange& range) {
  if (!(std::isfinite(box.x_min) && std::isfinite(box.y_min) && std::isfinite(box.x_max) &&
        std::isfinite(box.y_max))) {
    return false;
  }
  const float scale = 1.0f / static_cast<float>(reduction);
  const auto columns = static_cast<float>(small.width);
  const auto rows = static_cast<float>(small.height);
  range = {static_cast<int>(std::clamp(box.x_min * scale, 0.0f, columns)),
           static_cast<int>(std::clamp(box.x_max * scale, -1.0f, columns - 1.0f)),
           static_cast<int>(std::clamp(box.y_min * scale, 0.0f, rows)),
           static_cast<int>(std::clamp(box.y_max * scale, -1.0f, rows - 1.0f))};
  return range.first_column <= range.last_column && range.first_row <= range.last_row;
}

/// The depth (m) of what is in the middle of a box, of pixels that no nearer box has named; nothing
/// where these are too few.
std::optional<float> middleDepth(const PixelRange& range, const SmallFrame& small,
                                 const std::vector<std::uint8_t>& named,
                                 std::vector<float>& depths) {
  depths.clear();
  std::size_t pixels = 0;
  const int margin =
      static_cast<int>(kMiddle * static_cast<float>(range.last_column - range.first_column));
  for (int y = range.first_row; y <= range.last_row; ++y) {
    for (int x = range.first_column + margin; x <= range.last_column - margin; ++x) {
      const std::size_t i = small.index(y, x);
      ++pixels;
      if (small.depth[i] > 0.0f && named[i] != kNamed) {
        depths.push_back(small.depth[i]);
      }
    }
  }
  if (depths.size() < kFewest ||
      static_cast<float>(depths.size()) < kLeastShown * static_cast<float>(pixels)) {
    return std::nullopt;
  }
  const auto k = static_cast<std::ptrdiff_t>(kQuantile * static_cast<float>(depths.size()));
  std::nth_element(depths.begin(), depths.begin() + k, depths.end());
  return depths[static_cast<std::size_t>(k)];
}

void nameBox(const PixelRange& range, const SmallFrame& small, float middle, float box_depth,
             std::vector<std::uint8_t>& named) {
  for (int y = range.first_row; y <= range.last_row; ++y) {
    for (int x = range.first_column; x <= range.last_column; ++x) {
      const std::size_t i = small.index(y, x);
      const float z = small.depth[i];
      const bool alike = z > 0.0f && std::abs(z - middle) < box_depth;
      named[i] = std::max(named[i], alike ? kNamed : kInBox);
    }
  }
}

/// Names what the boxes hold, the nearest first: of who stands behind somebody else, the middle of
/// the box shows the other one.
void nameBoxes(const MotionMaskFrame& frame, const SmallFrame& small, int reduction,
               float box_depth, std::vector<std::uint8_t>& named, std::vector<float>& scratch) {
  std::vector<std::pair<float, PixelRange>> near_first;
  for (const DetectionBox& box : frame.regions.boxes) {
    PixelRange range{};
    if (rangeOf(box, small, reduction, range)) {
      near_first.emplace_back(middleDepth(range, small, named, scratch).value_or(kFarthest), range);
    }
  }
  std::stable_sort(near_first.begin(), near_first.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [depth, range] : near_first) {
    const std::optional<float> middle = middleDepth(range, small, named, scratch);
    nameBox(range, small, middle.value_or(-kFarthest), box_depth, named);
  }
}

std::int64_t labelAt(const cv::Mat& labels, int row, int column) {
  switch (labels.type()) {
    case CV_8UC1:
      return labels.at<std::uint8_t>(row, column);
    case CV_16UC1:
      return labels.at<std::uint16_t>(row, column);
    default:
      return labels.at<std::int32_t>(row, column);
  }
}

}  // namespace

std::vector<std::uint8_t> namedPixels(const MotionMaskFrame& frame, const SmallFrame& small,
                                      int reduction, float box_depth,
                                      std::vector<std::uint8_t> reuse,
                                      std::vector<float>& scratch) {
  std::vector<std::uint8_t> named = std::move(reuse);
  named.clear();
  if (frame.regions.boxes.empty() && frame.regions.labels.empty()) {
    return named;
  }
  named.assign(small.size(), 0);
  nameBoxes(frame, small, reduction, box_depth, named, scratch);
  if (frame.regions.labels.empty()) {
    return named;
  }
  for (int y = 0; y < small.height; ++y) {
    for (int x = 0; x < small.width; ++x) {
      const std::int64_t label = labelAt(frame.regions.labels, y * reduction + reduction / 2,
                                         x * reduction + reduction / 2);
      if (std::any_of(frame.regions.labelled.begin(), frame.regions.labelled.end(),
                      [&](const LabelRegion& region) { return region.label == label; })) {
        named[small.index(y, x)] = kNamed;
      }
    }
  }
  return named;
}

}  // namespace hmcdyn::internal

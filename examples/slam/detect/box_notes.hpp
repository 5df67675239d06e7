// SPDX-License-Identifier: BSD-3-Clause
// Boxes that could be boxes, but look as if they were of other images, or meant otherwise.
#pragma once

#include <algorithm>
#include <filesystem>
#include <vector>

#include <opencv2/core/types.hpp>

#include "slam/detect/box_plausibility.hpp"

namespace hmcdyn::slam {

/// Whether corners lie in the image, give or take 2 % of it.
inline bool fits(float x_min, float y_min, float x_max, float y_max, cv::Size image) {
  const float across = 0.02f * static_cast<float>(image.width);
  const float down = 0.02f * static_cast<float>(image.height);
  return x_min <= x_max && y_min <= y_max && x_min >= -across && y_min >= -down &&
         x_max <= static_cast<float>(image.width) + across &&
         y_max <= static_cast<float>(image.height) + down;
}

/// Whether all boxes are as `asIf` says; false where the image is not known.
template <class Fits>
bool allFit(const std::vector<TimedBox>& boxes, cv::Size image, const Fits& asIf) {
  return image.area() > 0 && std::all_of(boxes.begin(), boxes.end(),
                                         [&](const TimedBox& timed) { return asIf(timed.box); });
}

/// The same if the last two numbers were width and height.
inline bool allFitAsSize(const std::vector<TimedBox>& boxes, cv::Size image) {
  return allFit(boxes, image, [image](const DetectionBox& box) {
    return fits(box.x_min, box.y_min, box.x_min + box.x_max, box.y_min + box.y_max, image);
  });
}

/// Notes what is doubtful about boxes as a whole: the image's size, their axes, sizes for corners,
/// half the resolution, several for one thing.
/// @param review its counts are known, but for what is kept.
void noteDoubtful(const std::vector<TimedBox>& boxes, cv::Size image,
                  const std::filesystem::path& file, BoxReview& review);

}  // namespace hmcdyn::slam

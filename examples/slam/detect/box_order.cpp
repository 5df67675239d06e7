// SPDX-License-Identifier: BSD-3-Clause
#include "slam/detect/box_order.hpp"

#include <algorithm>
#include <array>

#include "slam/detect/box_notes.hpp"

namespace hmcdyn::slam {
namespace {

/// Another meaning of four numbers, and what makes corners of them.
struct NumberOrder {
  DetectionBox (*corners)(const DetectionBox&);
  const char* guess;
};

DetectionBox cornersOf(float x_min, float y_min, float x_max, float y_max) {
  DetectionBox box;
  box.x_min = x_min;
  box.y_min = y_min;
  box.x_max = x_max;
  box.y_max = y_max;
  return box;
}

/// In the order in which they are asked: few boxes fit as several of these, many as one.
constexpr std::array<NumberOrder, 6> kOrders{{
    {[](const DetectionBox& b) { return cornersOf(b.x_max, b.y_max, b.x_min, b.y_min); },
     "they look like corners in the order x_max y_max x_min y_min; swap them"},
    {[](const DetectionBox& b) {
       return cornersOf(b.x_min, b.y_min, b.x_min + b.x_max, b.y_min + b.y_max);
     },
     "they look like x y width height; write x_min y_min x_min + width y_min + height"},
    {[](const DetectionBox& b) { return cornersOf(b.x_min, b.x_max, b.y_min, b.y_max); },
     "they look like x_min x_max y_min y_max; swap the second and the third"},
    {[](const DetectionBox& b) {
       return cornersOf(b.x_min - b.x_max / 2, b.y_min - b.y_max / 2, b.x_min + b.x_max / 2,
                        b.y_min + b.y_max / 2);
     },
     "they look like centre and size; write centre - size / 2 and centre + size / 2"},
    {[](const DetectionBox& b) { return cornersOf(b.x_max, b.y_min, b.x_min, b.y_max); },
     "they look like corners in the order x_max y_min x_min y_max; swap the first and the third"},
    {[](const DetectionBox& b) { return cornersOf(b.x_min, b.y_max, b.x_max, b.y_min); },
     "they look like corners in the order x_min y_max x_max y_min; swap the second and the fourth"},
}};

}  // namespace

std::string guessOfOrder(const std::vector<TimedBox>& boxes, cv::Size image) {
  const auto* const found =
      std::find_if(kOrders.begin(), kOrders.end(), [&](const NumberOrder& order) {
        return allFit(boxes, image, [&](const DetectionBox& box) {
          const DetectionBox as = order.corners(box);
          return fits(as.x_min, as.y_min, as.x_max, as.y_max, image);
        });
      });
  return found == kOrders.end() ? std::string() : found->guess;
}

std::string guessOfCorners(const std::vector<TimedBox>& boxes, cv::Size image) {
  const bool sorted_fit = allFit(boxes, image, [image](const DetectionBox& box) {
    return fits(std::min(box.x_min, box.x_max), std::min(box.y_min, box.y_max),
                std::max(box.x_min, box.x_max), std::max(box.y_min, box.y_max), image);
  });
  return sorted_fit ? "they look like corners in no one order; write the smaller x and the smaller "
                      "y of each line first"
                    : "are they x y width height, or corners in another order?";
}

}  // namespace hmcdyn::slam

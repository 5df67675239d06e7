// SPDX-License-Identifier: BSD-3-Clause
#include "regions/frame_regions.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include <opencv2/core.hpp>

#include <hmcdyn/label_image.hpp>

namespace hmcdyn::internal {
namespace {

void checkLabels(const DynamicFeatureFilterInput& input) {
  if (!input.regions.boxes.empty()) {
    throw std::invalid_argument(
        "filterDynamicFeatures: " + std::to_string(input.regions.boxes.size()) +
        " boxes and a label image; expected one or the other");
  }
  const cv::Size image = input.pyramid->empty() ? cv::Size() : input.pyramid->front().size();
  if (input.regions.labels.size() != image) {
    throw std::invalid_argument(
        "filterDynamicFeatures: labels is " + std::to_string(input.regions.labels.cols) + " x " +
        std::to_string(input.regions.labels.rows) + " px; expected the image's " +
        std::to_string(image.width) + " x " + std::to_string(image.height));
  }
}

}  // namespace

FrameRegions regionsOf(const DynamicFeatureFilterInput& input) {
  FrameRegions result;
  result.by_mask = input.regions.byMask();
  if (!result.by_mask) {
    if (!input.regions.labelled.empty()) {
      throw std::invalid_argument(
          "filterDynamicFeatures: " + std::to_string(input.regions.labelled.size()) +
          " regions, but labels is empty; expected a label image");
    }
    result.boxes.assign(input.regions.boxes.begin(), input.regions.boxes.end());
    result.membership = assignToBoxes(input.points, input.regions.boxes);
    return result;
  }
  checkLabels(input);
  result.boxes = boundingBoxes(input.regions.labels, input.regions.labelled);
  result.region = regionsOfPoints(input.points, input.regions.labels, input.regions.labelled);
  result.membership = assignToRegions(result.region, input.regions.labelled.size());
  return result;
}

BoxMembership membershipOf(const FrameRegions& regions, const std::vector<std::size_t>& source,
                           const KeyPointsView& points, BoxMembership reuse) {
  if (!regions.by_mask) {
    return assignToBoxes(points, regions.boxes, std::move(reuse));
  }
  std::vector<int> region;
  region.reserve(source.size());
  for (const std::size_t i : source) {
    region.push_back(regions.region[i]);
  }
  return assignToRegions(region, regions.boxes.size(), std::move(reuse));
}

std::vector<std::uint8_t> inRegion(const FrameRegions& regions, std::size_t points) {
  std::vector<std::uint8_t> flags(points, 0);
  for (const std::uint32_t i : regions.membership.indices) {
    flags[i] = 1;
  }
  return flags;
}

double shareCovered(Span<const DetectionBox> boxes, const cv::Size& image) {
  // On a raster of 8 px: exact enough, and boxes may overlap in any way.
  constexpr int kRaster = 8;
  constexpr int kMiddle = kRaster / 2;
  const int columns = (image.width + kRaster - 1) / kRaster;
  const int rows = (image.height + kRaster - 1) / kRaster;
  int covered = 0;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const auto u = static_cast<float>(column * kRaster + kMiddle);
      const auto v = static_cast<float>(row * kRaster + kMiddle);
      covered += std::any_of(boxes.begin(), boxes.end(),
                             [&](const DetectionBox& box) { return box.contains(u, v); })
                     ? 1
                     : 0;
    }
  }
  return columns * rows == 0 ? 0.0
                             : static_cast<double>(covered) / static_cast<double>(columns * rows);
}

}  // namespace hmcdyn::internal

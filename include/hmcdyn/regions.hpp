// SPDX-License-Identifier: BSD-3-Clause
// Step 4 with masks in place of boxes: a point belongs to the region whose label lies under it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <hmcdyn/detail/requirements.hpp>
#include <hmcdyn/steps/box_dynamism.hpp>
#include <hmcdyn/types.hpp>

namespace hmcdyn {

/// A label per pixel, borrowed: row r starts at data + r * stride. What a segmentation gives: the
/// number of an instance, or of a class.
/// @tparam Label an integer, such as std::uint8_t, std::uint16_t or std::int32_t.
template <class Label>
struct LabelImageView {
  const Label* data = nullptr;  ///< Labels of the upper left pixel and those after it.
  int width = 0;                ///< Columns (px).
  int height = 0;               ///< Rows (px).
  std::size_t stride = 0;       ///< Elements from a row to the next, >= width.

  /// True where there is no pixel.
  bool empty() const noexcept { return data == nullptr || width <= 0 || height <= 0; }
  /// Label at a pixel, which must lie in the image.
  Label at(int column, int row) const noexcept {
    return data[static_cast<std::size_t>(row) * stride + static_cast<std::size_t>(column)];
  }
};

/// Which label is a region of its own, and what it shows. Labels without a region are background.
struct LabelRegion {
  int label = 1;                  ///< Value in the image.
  int class_id = kPersonClassId;  ///< COCO class, 0 = person; decides the threshold of the test.
  float score = 1.0f;             ///< Confidence, 0..1.
};

/// The region of a point that lies in none.
inline constexpr int kNoRegion = -1;

namespace detail {

/// Finds the region of a label: the first of those that have it. Few regions are searched one by
/// one, which takes no memory; many by halves.
class RegionOfLabel {
 public:
  explicit RegionOfLabel(Span<const LabelRegion> regions) : regions_(regions) {
    constexpr std::size_t kFew = 16;
    if (regions.size() <= kFew) {
      return;
    }
    by_label_.reserve(regions.size());
    for (std::size_t r = 0; r < regions.size(); ++r) {
      by_label_.emplace_back(regions[r].label, static_cast<int>(r));
    }
    std::sort(by_label_.begin(), by_label_.end());
  }

  /// kNoRegion where none has it.
  int operator()(std::int64_t label) const {
    if (by_label_.empty()) {
      const LabelRegion* const found =
          std::find_if(regions_.begin(), regions_.end(),
                       [&](const LabelRegion& candidate) { return candidate.label == label; });
      return found == regions_.end() ? kNoRegion : static_cast<int>(found - regions_.begin());
    }
    const auto found =
        std::partition_point(by_label_.begin(), by_label_.end(),
                             [&](const auto& candidate) { return candidate.first < label; });
    return found == by_label_.end() || found->first != label ? kNoRegion : found->second;
  }

 private:
  Span<const LabelRegion> regions_;
  std::vector<std::pair<int, int>> by_label_;  ///< Label and region; empty where there are few.
};

}  // namespace detail

/// Region of each of the N key points: the position in `regions` of the label at the point's
/// nearest pixel; kNoRegion for other labels and for points outside the image or not finite. Where
/// a label stands twice in `regions`, the first counts.
/// @throws std::invalid_argument for an empty image, a stride below the width, or unequal arrays.
template <class Label>
std::vector<int> regionsOfPoints(const KeyPointsView& points, const LabelImageView<Label>& labels,
                                 Span<const LabelRegion> regions) {
  checkKeyPoints(points);
  if (labels.empty() || labels.stride < static_cast<std::size_t>(labels.width)) {
    throw std::invalid_argument("regionsOfPoints: labels is " + std::to_string(labels.width) + "x" +
                                std::to_string(labels.height) + " px with a stride of " +
                                std::to_string(labels.stride) +
                                "; expected an image, and a stride of its width or more");
  }
  std::vector<int> region(points.size(), kNoRegion);
  const detail::RegionOfLabel region_of(regions);
  for (std::size_t i = 0; i < points.size(); ++i) {
    // Compared as float: what is far outside, or NaN, must not reach the cast to int.
    const float column = std::floor(points.u[i] + 0.5f);
    const float row = std::floor(points.v[i] + 0.5f);
    if (!(column >= 0.0f && row >= 0.0f && column < static_cast<float>(labels.width) &&
          row < static_cast<float>(labels.height))) {
      continue;
    }
    const auto label =
        static_cast<std::int64_t>(labels.at(static_cast<int>(column), static_cast<int>(row)));
    region[i] = region_of(label);
  }
  return region;
}

/// Which key points each region holds, as assignToBoxes says it for boxes: what testBoxes, the
/// cluster filter and the peers' rules work on.
/// @param region of each key point: kNoRegion, or 0 .. regions - 1 (regionsOfPoints, or your own).
/// @param reuse a result whose memory is taken over.
/// @throws std::invalid_argument for a region out of range.
inline BoxMembership assignToRegions(Span<const int> region, std::size_t regions,
                                     BoxMembership reuse = {}) {
  reuse.offsets.assign(regions + 1, 0);
  for (std::size_t i = 0; i < region.size(); ++i) {
    if (region[i] == kNoRegion) {
      continue;
    }
    if (region[i] < 0 || static_cast<std::size_t>(region[i]) >= regions) {
      throw std::invalid_argument("assignToRegions: region[" + std::to_string(i) + "] is " +
                                  std::to_string(region[i]) + "; expected -1 (none) or a number " +
                                  "below " + std::to_string(regions));
    }
    ++reuse.offsets[static_cast<std::size_t>(region[i]) + 1];
  }
  for (std::size_t r = 0; r < regions; ++r) {
    reuse.offsets[r + 1] += reuse.offsets[r];
  }
  reuse.indices.resize(reuse.offsets[regions]);
  std::vector<std::size_t> next(reuse.offsets.begin(), reuse.offsets.end() - 1);
  for (std::size_t i = 0; i < region.size(); ++i) {
    if (region[i] != kNoRegion) {
      reuse.indices[next[static_cast<std::size_t>(region[i])]++] = static_cast<std::uint32_t>(i);
    }
  }
  return reuse;
}

/// The tightest box around each region's pixels, with the region's class and score: for the steps
/// that ask where moving things may be, not which point lies on one (choice of points for the
/// camera's motion, margin of the optical flow). A region without a pixel gets a box that holds no
/// point, so that boxes and regions keep their numbers.
/// @throws std::invalid_argument for an empty image or a stride below the width.
template <class Label>
std::vector<DetectionBox> boundingBoxes(const LabelImageView<Label>& labels,
                                        Span<const LabelRegion> regions) {
  if (labels.empty() || labels.stride < static_cast<std::size_t>(labels.width)) {
    throw std::invalid_argument(
        "boundingBoxes: labels is empty, or its stride is below its width; expected an image");
  }
  std::vector<DetectionBox> boxes;
  boxes.reserve(regions.size());
  for (const LabelRegion& region : regions) {
    boxes.push_back({0.0f, 0.0f, -1.0f, -1.0f, region.class_id, region.score});
  }
  std::vector<std::uint8_t> seen(regions.size(), 0);
  const detail::RegionOfLabel region_of(regions);
  std::int64_t last = static_cast<std::int64_t>(labels.at(0, 0));
  int region = region_of(last);
  for (int row = 0; row < labels.height; ++row) {
    for (int column = 0; column < labels.width; ++column) {
      const auto label = static_cast<std::int64_t>(labels.at(column, row));
      if (label != last) {  // most pixels have their neighbour's label
        last = label;
        region = region_of(label);
      }
      if (region == kNoRegion) {
        continue;
      }
      const auto r = static_cast<std::size_t>(region);
      const auto x = static_cast<float>(column);
      const auto y = static_cast<float>(row);
      DetectionBox& box = boxes[r];
      box.x_min = seen[r] == 0 ? x : std::min(box.x_min, x);
      box.y_min = seen[r] == 0 ? y : box.y_min;  // rows come in order
      box.x_max = std::max(box.x_max, x);
      box.y_max = y;
      seen[r] = 1;
    }
  }
  return boxes;
}

}  // namespace hmcdyn

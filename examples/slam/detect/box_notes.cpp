// SPDX-License-Identifier: BSD-3-Clause
#include "slam/detect/box_notes.hpp"

#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include <hmcdyn/steps/box_carrier.hpp>

#include "slam/detect/coco_classes.hpp"

namespace hmcdyn::slam {
namespace {

/// Boxes of a larger image lie partly in a smaller one.
void noteAnotherSize(const BoxCounts& counts, cv::Size image, const std::filesystem::path& file,
                     BoxReview& review) {
  if (2 * (counts.beyond + counts.outside) > counts.in_file) {
    review.notes.push_back(fmt::format(
        "{}: {} of {} boxes reach beyond the image of {} x {}; are they of images of another size?",
        file.string(), counts.beyond + counts.outside, counts.in_file, image.width, image.height));
  }
}

/// Corners with y first mostly lie in the image, too, but people in them lie down.
void noteSwappedAxes(const std::vector<TimedBox>& boxes, cv::Size image,
                     const std::filesystem::path& file, BoxReview& review) {
  const bool fit_with_y_first = allFit(boxes, image, [image](const DetectionBox& box) {
    return fits(box.y_min, box.x_min, box.y_max, box.x_max, image);
  });
  constexpr std::size_t kLeast = 5;  // boxes
  constexpr float kLying = 1.5f;     // width to height
  std::size_t people = 0;
  std::size_t lying = 0;
  for (const TimedBox& timed : boxes) {
    const DetectionBox& box = timed.box;
    people += box.class_id == kPersonClassId ? 1 : 0;
    const bool wide = box.x_max - box.x_min > kLying * (box.y_max - box.y_min);
    lying += box.class_id == kPersonClassId && wide ? 1 : 0;
  }
  if (fit_with_y_first && people >= kLeast && 2 * lying > people) {
    review.notes.push_back(fmt::format(
        "{}: {} of the {} boxes of people are more than {:g} times as wide as high; are their "
        "corners in the order y_min x_min y_max x_max? expected x first",
        file.string(), lying, people, kLying));
  }
}

/// Median deviation from the median of what `value` gives of each box; not for none.
template <class Value>
float spreadOf(const std::vector<TimedBox>& boxes, const Value& value) {
  std::vector<float> values;
  values.reserve(boxes.size());
  for (const TimedBox& timed : boxes) {
    values.push_back(value(timed.box));
  }
  const auto middle = [](std::vector<float>& of) {
    const auto at = of.begin() + static_cast<std::ptrdiff_t>(of.size() / 2);
    std::nth_element(of.begin(), at, of.end());
    return *at;
  };
  const float median = middle(values);
  for (float& deviation : values) {
    deviation = std::abs(deviation - median);
  }
  return middle(values);
}

/// Where a person crosses the image the corners go along, and width and height stay.
void noteSizes(const std::vector<TimedBox>& boxes, cv::Size image,
               const std::filesystem::path& file, BoxReview& review) {
  constexpr std::size_t kLeast = 10;  // boxes
  constexpr float kMuchLess = 0.5f;   // of two corners that are found apart it is 0.7 or more
  if (boxes.size() < kLeast || !allFitAsSize(boxes, image)) {
    return;
  }
  const float of_last = spreadOf(boxes, [](const DetectionBox& box) { return box.x_max; }) +
                        spreadOf(boxes, [](const DetectionBox& box) { return box.y_max; });
  const float of_sides =
      spreadOf(boxes, [](const DetectionBox& box) { return box.x_max - box.x_min; }) +
      spreadOf(boxes, [](const DetectionBox& box) { return box.y_max - box.y_min; });
  if (of_last < kMuchLess * of_sides) {
    review.notes.push_back(fmt::format(
        "{}: all boxes fit as x y width height, too, and their last two numbers stay while the "
        "first two change; are they sizes? expected x_min y_min x_max y_max",
        file.string()));
  }
}

/// Boxes found in images of half the size.
void noteUpperLeftQuarter(const std::vector<TimedBox>& boxes, cv::Size image,
                          const std::filesystem::path& file, BoxReview& review) {
  constexpr std::size_t kLeast = 20;  // boxes
  if (boxes.size() < kLeast || image.area() == 0) {
    return;
  }
  float right = 0.0f;
  float bottom = 0.0f;
  for (const TimedBox& timed : boxes) {
    right = std::max(right, timed.box.x_max / static_cast<float>(image.width));
    bottom = std::max(bottom, timed.box.y_max / static_cast<float>(image.height));
  }
  const auto reaches_half = [](float share) { return share > 0.4f && share < 0.52f; };
  if (reaches_half(right) && reaches_half(bottom)) {
    review.notes.push_back(fmt::format(
        "{}: all {} boxes lie in the upper left quarter of the image of {} x {}, up to its middle; "
        "are they of images of half the size?",
        file.string(), boxes.size(), image.width, image.height));
  }
}

/// Several boxes around one thing at one time: of several frames, or as before suppression.
void noteCoinciding(const std::vector<TimedBox>& boxes, const std::filesystem::path& file,
                    BoxReview& review) {
  constexpr std::size_t kLeast = 5;      // boxes
  constexpr std::size_t kCompared = 20;  // with those that follow
  constexpr float kOneThing = 0.7f;      // intersection over union
  std::size_t coinciding = 0;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    for (std::size_t j = i + 1;
         j < boxes.size() && j <= i + kCompared && boxes[j].timestamp == boxes[i].timestamp; ++j) {
      if (boxes[i].box.class_id == boxes[j].box.class_id &&
          intersectionOverUnion(boxes[i].box, boxes[j].box) > kOneThing) {
        ++coinciding;
        break;
      }
    }
  }
  if (coinciding >= kLeast && 3 * coinciding > boxes.size()) {
    review.notes.push_back(fmt::format(
        "{}: {} of {} boxes nearly coincide with another of the same time stamp and class; were "
        "the time stamps rounded, or the boxes written before suppression (NMS)?",
        file.string(), coinciding, boxes.size()));
  }
}

}  // namespace

void noteDoubtful(const std::vector<TimedBox>& boxes, cv::Size image,
                  const std::filesystem::path& file, BoxReview& review) {
  noteAnotherSize(review.counts, image, file, review);
  noteSwappedAxes(boxes, image, file, review);
  noteSizes(boxes, image, file, review);
  noteUpperLeftQuarter(boxes, image, file, review);
  noteCoinciding(boxes, file, review);
}

}  // namespace hmcdyn::slam

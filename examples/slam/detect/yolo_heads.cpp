// SPDX-License-Identifier: BSD-3-Clause
#include "slam/detect/yolo_heads.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "slam/detect/coco_classes.hpp"
#include "slam/detect/yolo_decode.hpp"

namespace hmcdyn::slam {
namespace {

constexpr const char* kExport =
    "export a YOLOv5 (1 x N x 85) or YOLOv8/11 (1 x 84 x N) detector of COCO's 80 classes, without "
    "suppression inside (nms=False, no --end2end)";

std::vector<int> sidesOf(const cv::Mat& output) {
  return {output.size.p, output.size.p + output.dims};
}

/// A head of so many values a candidate; empty where the number says nothing.
std::string byValues(int values, int candidates) {
  constexpr int kV8 = 4 + kCocoClassCount;
  constexpr int kMasks = 32;
  if (values == kV8 + kMasks || values == kV8 + 1 + kMasks) {
    return "a segmentation head (boxes, classes and 32 mask coefficients)";
  }
  if (values == 56 || values == 57) {
    return "a pose head (17 key points a person)";
  }
  if (values == 6 && candidates <= 1000) {
    return "boxes after suppression (x y x y score class), as YOLOv10 or an export with nms=True "
           "gives them";
  }
  if (values == 7) {
    return "boxes after suppression (image, corners, class, score), as YOLOv7 --end2end gives them";
  }
  if (values == kV8) {
    return "rows of 84 values, a transposed YOLOv8 or a DETR";
  }
  if (values > 4 && values < kV8 && candidates > 1000) {
    return fmt::format("a detector of {} classes", values - 4);
  }
  return {};
}

std::string guessOf(const std::vector<int>& sides) {
  if (sides.size() == 5 && sides[4] == 5 + kCocoClassCount) {
    return "one scale of a YOLO head that is not decoded, as a YOLOv7 export without --grid or a "
           "YOLOv5 one with --train has three of";
  }
  if (sides.size() == 4 &&
      (sides[1] % (5 + kCocoClassCount) == 0 || sides[1] == 64 + kCocoClassCount)) {
    return "one scale of a YOLO head that is not decoded";
  }
  if (sides.size() == 3) {
    const std::string rows = byValues(sides[2], sides[1]);
    return rows.empty() || sides[1] < sides[2] ? byValues(sides[1], sides[2]) : rows;
  }
  if (sides.size() == 2) {
    return byValues(sides[1], sides[0]);
  }
  return {};
}

struct Ranges {
  float largest_centre = 0.0f;
  float smallest_size = std::numeric_limits<float>::infinity();
  float largest_size = 0.0f;
  float smallest_score = 0.0f;
  float largest_score = 0.0f;
};

Ranges rangesOf(const cv::Mat& rows) {
  Ranges ranges;
  for (int i = 0; i < rows.rows; ++i) {
    const auto* const row = rows.ptr<float>(i);
    ranges.largest_centre = std::max({ranges.largest_centre, row[0], row[1]});
    ranges.smallest_size = std::min({ranges.smallest_size, row[2], row[3]});
    ranges.largest_size = std::max({ranges.largest_size, row[2], row[3]});
    for (int k = 4; k < rows.cols; ++k) {
      ranges.smallest_score = std::min(ranges.smallest_score, row[k]);
      ranges.largest_score = std::max(ranges.largest_score, row[k]);
    }
  }
  return ranges;
}

}  // namespace

std::string guessOfHead(const std::vector<cv::Mat>& outputs) {
  if (outputs.empty()) {
    return fmt::format("the network has no output; {}", kExport);
  }
  std::vector<std::string> shapes;
  std::string guess;
  for (const cv::Mat& output : outputs) {
    shapes.push_back(shapeOf(output));
    guess = guess.empty() ? guessOf(sidesOf(output)) : guess;
  }
  return fmt::format(
      "its output is {}{}; {}", fmt::join(shapes, ", "),
      guess.empty() ? std::string(", of no head that is known here") : ": it looks like " + guess,
      kExport);
}

std::string whatIsWrongWithHead(const cv::Mat& output, int input_size) {
  const bool v5 = yoloHeadOf(output) == YoloHead::kYoloV5;
  const cv::Mat rows = v5 ? output.reshape(1, {output.size[1], output.size[2]})
                          : cv::Mat(output.reshape(1, {output.size[1], output.size[2]}).t());
  constexpr int kEnough = 21;  // of the smallest input, 32 px, with one anchor a cell
  if (rows.rows < kEnough) {
    return {};
  }
  const Ranges ranges = rangesOf(rows);
  constexpr float kShare = 1.5f;
  constexpr float kProbability = 1.001f;  // rounding
  if (ranges.largest_centre <= kShare && ranges.largest_size <= kShare &&
      ranges.smallest_size >= 0.0f) {
    return "its boxes lie within 0..1: shares of the input where pixels are expected; export with "
           "pixels (not for TensorFlow or EdgeTPU)";
  }
  if (ranges.smallest_size < 0.0f ||
      ranges.largest_centre < static_cast<float>(input_size) / 8.0f) {
    return fmt::format(
        "its boxes do not cover the input (centres up to {:.3g} of {} px, sizes from {:.3g}): it "
        "looks like a YOLOX head, or another one that is not decoded; export it with the decoding "
        "(YOLOX: --decode_in_inference)",
        ranges.largest_centre, input_size, ranges.smallest_size);
  }
  if (ranges.smallest_score < 1.0f - kProbability || ranges.largest_score > kProbability) {
    return fmt::format(
        "its scores lie in {:.3g}..{:.3g}; expected probabilities: export it with the sigmoid",
        ranges.smallest_score, ranges.largest_score);
  }
  return {};
}

}  // namespace hmcdyn::slam

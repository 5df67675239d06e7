// SPDX-License-Identifier: BSD-3-Clause
#include "slam/detect/yolo_decode.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

#include "slam/detect/coco_classes.hpp"

namespace hmcdyn::slam {
namespace {

constexpr int kBoxValues = 4;                                // cx cy w h
constexpr int kV8Values = kBoxValues + kCocoClassCount;      // 84
constexpr int kV5Values = kBoxValues + 1 + kCocoClassCount;  // 85

// The box of one candidate, nothing where it is too weak or not a box.
// `factor` is its objectness; `scale` turns its coordinates into pixels.
std::optional<DetectionBox> decodeCandidate(const float* candidate, const float* classes,
                                            float factor, cv::Size2f scale, float score_threshold) {
  const float* const best = std::max_element(classes, classes + kCocoClassCount);
  const float x = candidate[0] * scale.width;
  const float y = candidate[1] * scale.height;
  const float half_width = candidate[2] * scale.width / 2.0f;
  const float half_height = candidate[3] * scale.height / 2.0f;
  const float score = factor * *best;
  const bool usable = score >= score_threshold && half_width > 0.0f && half_height > 0.0f &&
                      std::isfinite(score) && std::isfinite(x) && std::isfinite(y) &&
                      std::isfinite(half_width) && std::isfinite(half_height);
  if (!usable) {
    return std::nullopt;
  }
  return DetectionBox{x - half_width,
                      y - half_height,
                      x + half_width,
                      y + half_height,
                      static_cast<int>(best - classes),
                      score};
}

// The boxes of candidates in rows; coordinates first, the classes from `first_class` on.
std::vector<DetectionBox> decodeRows(const cv::Mat& rows, int first_class, bool has_objectness,
                                     cv::Size2f scale, float score_threshold) {
  std::vector<DetectionBox> boxes;
  for (int i = 0; i < rows.rows; ++i) {
    const auto* const row = rows.ptr<float>(i);
    const float factor = has_objectness ? row[kBoxValues] : 1.0f;
    if (!(factor >= score_threshold)) {
      continue;  // no probability is above 1: spares most rows the search for their class
    }
    if (const auto box = decodeCandidate(row, row + first_class, factor, scale, score_threshold)) {
      boxes.push_back(*box);
    }
  }
  return boxes;
}

void requireHead(const cv::Mat& output, YoloHead expected, const char* function) {
  if (yoloHeadOf(output) != expected) {
    throw std::invalid_argument(
        fmt::format("{}: output has the shape {} of the other head", function, shapeOf(output)));
  }
}

}  // namespace

std::string shapeOf(const cv::Mat& array) {
  std::vector<int> sides;
  sides.reserve(static_cast<std::size_t>(array.dims));
  for (int i = 0; i < array.dims; ++i) {
    sides.push_back(array.size[i]);
  }
  return fmt::format("{}", fmt::join(sides, " x "));
}

YoloHead yoloHeadOf(const cv::Mat& output) {
  if (output.dims == 3 && output.size[0] == 1 && output.type() == CV_32F) {
    if (output.size[2] == kV5Values) {
      return YoloHead::kYoloV5;
    }
    if (output.size[1] == kV8Values) {
      return YoloHead::kYoloV8;
    }
  }
  throw std::invalid_argument(fmt::format(
      "YOLO output has the shape {} of {}; expected 1 x N x {} (YOLOv5) or 1 x {} x N "
      "(YOLOv8) of CV_32F: {} COCO classes",
      shapeOf(output), cv::typeToString(output.type()), kV5Values, kV8Values, kCocoClassCount));
}

std::vector<DetectionBox> decodeYoloV5(const cv::Mat& output, float score_threshold) {
  requireHead(output, YoloHead::kYoloV5, "decodeYoloV5");
  const cv::Mat rows = output.reshape(1, {output.size[1], kV5Values});
  return decodeRows(rows, kBoxValues + 1, true, {1.0f, 1.0f}, score_threshold);
}

std::vector<DetectionBox> decodeYoloV8(const cv::Mat& output, float score_threshold) {
  requireHead(output, YoloHead::kYoloV8, "decodeYoloV8");
  const cv::Mat rows = output.reshape(1, {kV8Values, output.size[2]}).t();
  return decodeRows(rows, kBoxValues, false, {1.0f, 1.0f}, score_threshold);
}

std::vector<DetectionBox> decodeDarknet(const cv::Mat& output, cv::Size image,
                                        float score_threshold) {
  if (output.dims != 2 || output.cols != kV5Values || output.type() != CV_32F) {
    throw std::invalid_argument(
        fmt::format("Darknet output has the shape {} of {}; expected N x {} of CV_32F: {} COCO "
                    "classes",
                    shapeOf(output), cv::typeToString(output.type()), kV5Values, kCocoClassCount));
  }
  return decodeRows(output, kBoxValues + 1, false, cv::Size2f(image), score_threshold);
}

}  // namespace hmcdyn::slam

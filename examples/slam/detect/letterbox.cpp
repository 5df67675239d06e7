// SPDX-License-Identifier: BSD-3-Clause
#include "slam/detect/letterbox.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

namespace hmcdyn::slam {
namespace {

// The factors as they are after rounding the scaled image to whole pixels, a side each.
cv::Point2d scaleOf(const Letterbox& letterbox) {
  return {static_cast<double>(letterbox.scaled.width) / letterbox.image.width,
          static_cast<double>(letterbox.scaled.height) / letterbox.image.height};
}

}  // namespace

Letterbox makeLetterbox(cv::Size image, int input_size) {
  if (image.width < 1 || image.height < 1 || input_size < 1) {
    throw std::invalid_argument(
        fmt::format("makeLetterbox: image {} x {} into an input of {}; expected sides above 0",
                    image.width, image.height, input_size));
  }
  const double factor = std::min(static_cast<double>(input_size) / image.width,
                                 static_cast<double>(input_size) / image.height);
  const auto scaled = [factor](int side) {
    return std::max(1, static_cast<int>(std::lround(factor * side)));
  };
  Letterbox letterbox;
  letterbox.image = image;
  letterbox.scaled = {scaled(image.width), scaled(image.height)};
  letterbox.offset = {(input_size - letterbox.scaled.width) / 2,
                      (input_size - letterbox.scaled.height) / 2};
  letterbox.input_size = input_size;
  return letterbox;
}

cv::Mat toInput(const cv::Mat& bgr, const Letterbox& letterbox) {
  constexpr double kGray = 114.0;  // what YOLOv5 and YOLOv8 are trained with
  cv::Mat input(letterbox.input_size, letterbox.input_size, CV_8UC3, cv::Scalar::all(kGray));
  cv::Mat part = input(cv::Rect(letterbox.offset, letterbox.scaled));
  cv::resize(bgr, part, letterbox.scaled, 0.0, 0.0, cv::INTER_LINEAR);
  return input;
}

DetectionBox toInput(const DetectionBox& box, const Letterbox& letterbox) {
  const cv::Point2d scale = scaleOf(letterbox);
  const cv::Point2d offset = letterbox.offset;
  DetectionBox mapped = box;
  mapped.x_min = static_cast<float>(box.x_min * scale.x + offset.x);
  mapped.y_min = static_cast<float>(box.y_min * scale.y + offset.y);
  mapped.x_max = static_cast<float>(box.x_max * scale.x + offset.x);
  mapped.y_max = static_cast<float>(box.y_max * scale.y + offset.y);
  return mapped;
}

DetectionBox toImage(const DetectionBox& box, const Letterbox& letterbox) {
  const cv::Point2d scale = scaleOf(letterbox);
  const cv::Point2d offset = letterbox.offset;
  DetectionBox mapped = box;
  mapped.x_min = static_cast<float>((box.x_min - offset.x) / scale.x);
  mapped.y_min = static_cast<float>((box.y_min - offset.y) / scale.y);
  mapped.x_max = static_cast<float>((box.x_max - offset.x) / scale.x);
  mapped.y_max = static_cast<float>((box.y_max - offset.y) / scale.y);
  return mapped;
}

}  // namespace hmcdyn::slam

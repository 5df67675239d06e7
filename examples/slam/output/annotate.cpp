// SPDX-License-Identifier: BSD-3-Clause
#include "slam/output/annotate.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "slam/detection/coco_classes.hpp"

namespace hmcdyn::slam {
namespace {

constexpr double kFontScale = 0.42;
const int kFont = cv::FONT_HERSHEY_SIMPLEX;

cv::Scalar colorOf(PointLabel label) {
  switch (label) {
    case PointLabel::kStatic:
      return {80, 200, 60};
    case PointLabel::kSuspect:
      return {0, 220, 255};
    case PointLabel::kDynamic:
      return {40, 40, 235};
    case PointLabel::kUnmatched:
      return {235, 150, 40};
  }
  return {255, 255, 255};
}

/// Qualitative palette (BGR), told apart on any background.
cv::Scalar colorOfCluster(int cluster) {
  static const std::array<cv::Scalar, 8> kPalette = {
      cv::Scalar(194, 99, 255), cv::Scalar(255, 255, 80),  cv::Scalar(0, 140, 255),
      cv::Scalar(255, 255, 255), cv::Scalar(180, 105, 0),  cv::Scalar(170, 240, 170),
      cv::Scalar(130, 0, 130),  cv::Scalar(0, 90, 130)};
  return kPalette[static_cast<std::size_t>(cluster) % kPalette.size()];
}

/// Text on a dark ground, legible on any picture.
void drawText(cv::Mat& picture, const std::string& text, cv::Point left_base,
              const cv::Scalar& color) {
  int baseline = 0;
  const cv::Size size = cv::getTextSize(text, kFont, kFontScale, 1, &baseline);
  cv::Rect ground(left_base.x - 2, left_base.y - size.height - 2, size.width + 4,
                  size.height + baseline + 3);
  ground &= cv::Rect({}, picture.size());
  if (!ground.empty()) {
    cv::Mat area = picture(ground);
    area.convertTo(area, -1, 0.35);
  }
  cv::putText(picture, text, left_base, kFont, kFontScale, color, 1, cv::LINE_AA);
}

void drawBox(cv::Mat& picture, const DetectionBox& box, bool is_dynamic) {
  const cv::Scalar color = is_dynamic ? colorOf(PointLabel::kDynamic) : colorOf(PointLabel::kStatic);
  const cv::Point upper_left(cvRound(box.x_min), cvRound(box.y_min));
  cv::rectangle(picture, upper_left, cv::Point(cvRound(box.x_max), cvRound(box.y_max)), color, 2);
  const bool is_known = box.class_id >= 0 && box.class_id < kCocoClassCount;
  const std::string name =
      is_known ? cocoClassName(box.class_id) : "class " + std::to_string(box.class_id);
  drawText(picture, fmt::format("{} {:.2f}{}", name, box.score, is_dynamic ? " moves" : ""),
           cv::Point(std::max(2, upper_left.x + 3), std::max(12, upper_left.y + 14)), color);
}

void drawLegend(cv::Mat& picture) {
  int x = 6;
  for (const PointLabel label : {PointLabel::kStatic, PointLabel::kSuspect, PointLabel::kDynamic,
                                 PointLabel::kUnmatched}) {
    drawText(picture, toString(label), {x, 14}, colorOf(label));
    x += 10 + cv::getTextSize(toString(label), kFont, kFontScale, 1, nullptr).width;
  }
  drawText(picture, "ring: cluster", {x, 14}, {255, 255, 255});
}

void check(const cv::Mat& bgr, const Annotation& annotation) {
  checkKeyPoints(annotation.points);
  const std::size_t n = annotation.points.size();
  if (bgr.empty() || bgr.type() != CV_8UC3) {
    throw std::invalid_argument("annotateFrame: expected a colour image (CV_8UC3)");
  }
  if (annotation.label.size() != n || annotation.cluster.size() != n ||
      annotation.box_is_dynamic.size() != annotation.boxes.size()) {
    throw std::invalid_argument(
        fmt::format("annotateFrame: {} points, {} labels, {} clusters; {} boxes, {} flags; expected "
                    "equal sizes",
                    n, annotation.label.size(), annotation.cluster.size(), annotation.boxes.size(),
                    annotation.box_is_dynamic.size()));
  }
}

}  // namespace

cv::Mat annotateFrame(const cv::Mat& bgr, const Annotation& annotation) {
  check(bgr, annotation);
  cv::Mat picture = bgr.clone();
  for (std::size_t b = 0; b < annotation.boxes.size(); ++b) {
    drawBox(picture, annotation.boxes[b], annotation.box_is_dynamic[b] != 0);
  }
  for (std::size_t i = 0; i < annotation.points.size(); ++i) {
    const cv::Point2f pixel(annotation.points.u[i], annotation.points.v[i]);
    if (annotation.cluster[i] >= 0) {
      cv::circle(picture, pixel, 4, colorOfCluster(annotation.cluster[i]), 1, cv::LINE_AA);
    }
    cv::circle(picture, pixel, 2, colorOf(annotation.label[i]), cv::FILLED, cv::LINE_AA);
  }
  drawLegend(picture);
  drawText(picture, annotation.status, {6, picture.rows - 8}, {255, 255, 255});
  return picture;
}

}  // namespace hmcdyn::slam

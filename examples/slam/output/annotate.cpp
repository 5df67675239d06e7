// SPDX-License-Identifier: BSD-3-Clause
#include "slam/output/annotate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

namespace hmcdyn::slam {
namespace {

constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr double kFontScale = 0.42;

// BGR.
const cv::Scalar kGreen(60, 220, 60);
const cv::Scalar kYellow(0, 230, 255);
const cv::Scalar kRed(50, 50, 255);
const cv::Scalar kBlueGrey(230, 170, 120);
const cv::Scalar kBlack(0, 0, 0);
const cv::Scalar kWhite(255, 255, 255);
const cv::Scalar kStrip(32, 32, 32);

constexpr std::array<PointLabel, 4> kLabels{PointLabel::kStatic, PointLabel::kSuspect,
                                            PointLabel::kDynamic, PointLabel::kUnmatched};

/// Colours told apart from each other and from the labels' (after Brewer's qualitative sets).
cv::Scalar clusterColour(int cluster) {
  static const std::array<cv::Scalar, 8> kPalette{{{200, 60, 230},
                                                   {255, 200, 0},
                                                   {0, 128, 255},
                                                   {255, 255, 170},
                                                   {90, 90, 160},
                                                   {203, 192, 255},
                                                   {255, 100, 100},
                                                   {0, 110, 0}}};
  return kPalette[static_cast<std::size_t>(cluster) % kPalette.size()];
}

cv::Scalar labelColour(PointLabel label) {
  switch (label) {
    case PointLabel::kStatic:
      return kGreen;
    case PointLabel::kSuspect:
      return kYellow;
    case PointLabel::kDynamic:
      return kRed;
    case PointLabel::kUnmatched:
      break;
  }
  return kBlueGrey;
}

void drawMarker(cv::Mat& canvas, cv::Point at, PointLabel label) {
  const cv::Scalar colour = labelColour(label);
  switch (label) {
    case PointLabel::kDynamic:
      cv::drawMarker(canvas, at, kBlack, cv::MARKER_TILTED_CROSS, 8, 4);
      cv::drawMarker(canvas, at, colour, cv::MARKER_TILTED_CROSS, 8, 2);
      break;
    case PointLabel::kSuspect:
      cv::rectangle(canvas, at - cv::Point(3, 3), at + cv::Point(3, 3), kBlack, cv::FILLED);
      cv::rectangle(canvas, at - cv::Point(2, 2), at + cv::Point(2, 2), colour, cv::FILLED);
      break;
    default:
      cv::circle(canvas, at, 3, kBlack, cv::FILLED);
      cv::circle(canvas, at, 2, colour, cv::FILLED);
      break;
  }
}

/// Text on a dark plate, its lower left corner at `at`; returns the plate's right end.
int drawText(cv::Mat& canvas, const std::string& text, cv::Point at, const cv::Scalar& colour,
             const cv::Scalar& plate) {
  int baseline = 0;
  const cv::Size size = cv::getTextSize(text, kFont, kFontScale, 1, &baseline);
  cv::rectangle(canvas, {at.x, at.y - size.height - 5, size.width + 6, size.height + 8}, plate,
                cv::FILLED);
  cv::putText(canvas, text, {at.x + 3, at.y - 1}, kFont, kFontScale, colour, 1, cv::LINE_AA);
  return at.x + size.width + 6;
}

std::string className(int id, const std::vector<std::string>& names) {
  return id >= 0 && static_cast<std::size_t>(id) < names.size()
             ? names[static_cast<std::size_t>(id)]
             : fmt::format("class {}", id);
}

/// False for an inverted box and one with a NaN.
bool isDrawable(const DetectionBox& box) {
  return box.x_min <= box.x_max && box.y_min <= box.y_max;
}

/// A corner in whole pixels. Just outside the picture is as good as far outside, and does not
/// overflow.
cv::Point clamped(const cv::Mat& picture, float x, float y) {
  constexpr float kOutside = 10.0f;
  return {cvRound(std::clamp(x, -kOutside, static_cast<float>(picture.cols) + kOutside)),
          cvRound(std::clamp(y, -kOutside, static_cast<float>(picture.rows) + kOutside))};
}

void drawBox(cv::Mat& picture, const DetectionBox& box, bool dynamic) {
  cv::rectangle(picture, clamped(picture, box.x_min, box.y_min),
                clamped(picture, box.x_max, box.y_max), dynamic ? kRed : kGreen, 2);
}

void drawBoxLabel(cv::Mat& picture, const DetectionBox& box, bool dynamic,
                  const std::vector<std::string>& names) {
  const cv::Point corner = clamped(picture, box.x_min, box.y_min);
  drawText(picture, fmt::format("{} {:.2f}", className(box.class_id, names), box.score),
           {std::max(0, corner.x - 1), std::max(16, corner.y)}, kBlack, dynamic ? kRed : kGreen);
}

std::string statusLine(const AnnotationText& text, std::size_t points,
                       Span<const std::uint8_t> box_is_dynamic) {
  const auto dynamic = std::count_if(box_is_dynamic.begin(), box_is_dynamic.end(),
                                     [](std::uint8_t flag) { return flag != 0; });
  return fmt::format("frame {}  model {}  {} points  {}/{} boxes dynamic", text.frame,
                     text.model.empty() ? "none" : text.model, points, dynamic,
                     box_is_dynamic.size());
}

/// Status line and legend, two lines.
void drawStrip(cv::Mat strip, const std::string& status, Span<const PointLabel> labels,
               bool clustered) {
  constexpr int kGap = 14;
  strip.setTo(kStrip);
  int x = drawText(strip, status, {4, 18}, kWhite, kStrip) + kGap;
  for (const auto& [name, colour] : {std::pair("dynamic", kRed), std::pair("other", kGreen)}) {
    cv::rectangle(strip, {x, 8, 12, 9}, colour, 2);
    x = drawText(strip, name, {x + kGap, 18}, colour, kStrip) + kGap;
  }
  x = 12;
  for (const PointLabel label : kLabels) {
    drawMarker(strip, {x, 33}, label);
    const auto count = std::count(labels.begin(), labels.end(), label);
    x = drawText(strip, fmt::format("{} {}", toString(label), count), {x + 6, 38},
                 labelColour(label), kStrip) +
        kGap;
  }
  if (clustered) {
    for (int i = 0; i < 3; ++i, x += kGap) {
      cv::circle(strip, {x, 33}, 6, clusterColour(i), 1, cv::LINE_AA);
    }
    drawText(strip, "ring: cluster", {x - 6, 38}, kWhite, kStrip);
  }
}

void checkInput(const cv::Mat& bgr, const KeyPointsView& points, std::size_t labels,
                std::size_t clusters, std::size_t boxes, std::size_t flags) {
  if (bgr.empty() || bgr.type() != CV_8UC3) {
    throw std::invalid_argument("annotate: the image is " +
                                (bgr.empty() ? "empty" : cv::typeToString(bgr.type())) +
                                "; expected CV_8UC3");
  }
  checkKeyPoints(points);
  if (labels != points.size() || clusters != points.size()) {
    throw std::invalid_argument(
        fmt::format("annotate: {} points, {} labels, {} clusters; expected equal sizes",
                    points.size(), labels, clusters));
  }
  if (flags != boxes) {
    throw std::invalid_argument(
        fmt::format("annotate: {} boxes, {} dynamic flags; expected equal sizes", boxes, flags));
  }
}

}  // namespace

cv::Mat annotateFrame(const cv::Mat& bgr, KeyPointsView points, Span<const PointLabel> labels,
                      Span<const int> clusters, Span<const DetectionBox> boxes,
                      Span<const std::uint8_t> box_is_dynamic, const AnnotationText& text) {
  checkInput(bgr, points, labels.size(), clusters.size(), boxes.size(), box_is_dynamic.size());
  cv::Mat canvas(bgr.rows + kAnnotationRows, bgr.cols, CV_8UC3);
  cv::Mat picture = canvas.rowRange(0, bgr.rows);
  bgr.copyTo(picture);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (isDrawable(boxes[i])) {
      drawBox(picture, boxes[i], box_is_dynamic[i] != 0);
    }
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const cv::Rect2f frame(0.0f, 0.0f, static_cast<float>(bgr.cols), static_cast<float>(bgr.rows));
    if (!frame.contains({points.u[i], points.v[i]})) {
      continue;  // NaN is nowhere, too
    }
    const cv::Point at(cvRound(points.u[i]), cvRound(points.v[i]));
    if (clusters[i] >= 0) {
      cv::circle(picture, at, 6, clusterColour(clusters[i]), 1, cv::LINE_AA);
    }
    drawMarker(picture, at, labels[i]);
  }
  for (std::size_t i = 0; i < boxes.size(); ++i) {  // on top of the points
    if (isDrawable(boxes[i])) {
      drawBoxLabel(picture, boxes[i], box_is_dynamic[i] != 0, text.class_names);
    }
  }
  const bool clustered =
      std::any_of(clusters.begin(), clusters.end(), [](int cluster) { return cluster >= 0; });
  drawStrip(canvas.rowRange(bgr.rows, canvas.rows), statusLine(text, points.size(), box_is_dynamic),
            labels, clustered);
  return canvas;
}

}  // namespace hmcdyn::slam

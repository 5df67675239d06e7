// SPDX-License-Identifier: BSD-3-Clause
#include "slam/input/camera/rectifier.hpp"

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace hmcdyn::slam {
namespace {

cv::Matx33d cameraMatrix(const PinholeCamera& pinhole) {
  return {pinhole.fx, 0.0, pinhole.cx, 0.0, pinhole.fy, pinhole.cy, 0.0, 0.0, 1.0};
}

// Points on the border of a box, corners included.
std::vector<cv::Point2d> borderPoints(double x_min, double y_min, double x_max, double y_max) {
  constexpr std::size_t kSteps =
      32;  // a side; the lens bends it by far less than a pixel between two
  std::vector<cv::Point2d> points;
  points.reserve(4 * (kSteps + 1));
  for (std::size_t i = 0; i <= kSteps; ++i) {
    const double part = static_cast<double>(i) / static_cast<double>(kSteps);
    const double x = x_min + part * (x_max - x_min);
    const double y = y_min + part * (y_max - y_min);
    points.insert(points.end(), {{x, y_min}, {x, y_max}, {x_min, y}, {x_max, y}});
  }
  return points;
}

}  // namespace

Rectifier::Rectifier(const CameraCalibration& calibration) : calibration_(calibration) {
  if (!hasDistortion(calibration)) {
    return;
  }
  const cv::Matx33d camera = cameraMatrix(calibration.pinhole);
  const cv::Mat distortion(calibration.distortion, true);
  cv::Mat x;
  cv::Mat y;
  cv::initUndistortRectifyMap(camera, distortion, cv::noArray(), camera,
                              {calibration.width, calibration.height}, CV_32FC1, x, y);
  cv::convertMaps(x, y, map_whole_, map_fraction_, CV_16SC2, false);
  cv::convertMaps(x, y, nearest_, cv::noArray(), CV_16SC2, true);
}

void Rectifier::checkSize(const cv::Mat& image) const {
  if (image.cols != calibration_.width || image.rows != calibration_.height) {
    throw std::invalid_argument(
        fmt::format("Rectifier: image is {} x {} pixels; the calibration says {} x {}", image.cols,
                    image.rows, calibration_.width, calibration_.height));
  }
}

cv::Mat Rectifier::color(const cv::Mat& image) const {
  checkSize(image);
  if (isIdentity()) {
    return image;
  }
  cv::Mat rectified;
  cv::remap(image, rectified, map_whole_, map_fraction_, cv::INTER_LINEAR, cv::BORDER_CONSTANT);
  return rectified;
}

cv::Mat Rectifier::depth(const cv::Mat& image) const {
  checkSize(image);
  if (isIdentity()) {
    return image;
  }
  cv::Mat rectified;
  cv::remap(image, rectified, nearest_, cv::noArray(), cv::INTER_NEAREST, cv::BORDER_CONSTANT);
  return rectified;
}

cv::Mat Rectifier::validMask() const {
  return depth(cv::Mat(calibration_.height, calibration_.width, CV_8UC1, cv::Scalar(255)));
}

template <class Map>
DetectionBox Rectifier::mapped(const DetectionBox& from, const Map& map) const {
  const double x_min = std::max<double>(from.x_min, 0.0);
  const double y_min = std::max<double>(from.y_min, 0.0);
  const double x_max = std::min<double>(from.x_max, calibration_.width - 1.0);
  const double y_max = std::min<double>(from.y_max, calibration_.height - 1.0);
  if (isIdentity() || !(from.x_min <= from.x_max) || !(from.y_min <= from.y_max) || x_min > x_max ||
      y_min > y_max) {
    return from;
  }
  const std::vector<cv::Point2d> border = map(borderPoints(x_min, y_min, x_max, y_max));
  const auto [left, right] = std::minmax_element(
      border.begin(), border.end(), [](const auto& a, const auto& b) { return a.x < b.x; });
  const auto [top, bottom] = std::minmax_element(
      border.begin(), border.end(), [](const auto& a, const auto& b) { return a.y < b.y; });
  DetectionBox box = from;
  box.x_min = static_cast<float>(left->x);
  box.y_min = static_cast<float>(top->y);
  box.x_max = static_cast<float>(right->x);
  box.y_max = static_cast<float>(bottom->y);
  return box;
}

DetectionBox Rectifier::box(const DetectionBox& raw) const {
  return mapped(raw, [this](const std::vector<cv::Point2d>& border) {
    const cv::Matx33d camera = cameraMatrix(calibration_.pinhole);
    const cv::Mat distortion(calibration_.distortion, true);
    std::vector<cv::Point2d> rectified;
    const cv::TermCriteria until(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 100, 1e-4);
    cv::undistortPoints(border, rectified, camera, distortion, cv::noArray(), camera, until);
    return rectified;
  });
}

DetectionBox Rectifier::rawBox(const DetectionBox& rectified) const {
  return mapped(rectified, [this](const std::vector<cv::Point2d>& border) {
    const PinholeCamera& pinhole = calibration_.pinhole;
    std::vector<cv::Point3d> rays;
    rays.reserve(border.size());
    for (const cv::Point2d& pixel : border) {
      rays.emplace_back((pixel.x - pinhole.cx) / pinhole.fx, (pixel.y - pinhole.cy) / pinhole.fy,
                        1.0);
    }
    std::vector<cv::Point2d> raw;
    cv::projectPoints(rays, cv::Vec3d(), cv::Vec3d(), cameraMatrix(pinhole),
                      cv::Mat(calibration_.distortion, true), raw);
    return raw;
  });
}

}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include <hmcdyn/types.hpp>

#include "slam/input/camera/calibration.hpp"

namespace hmcdyn::slam {

/// Takes the lens distortion (Brown-Conrady) out of images and boxes, for the same pinhole camera
/// and image size: what comes after it knows no distortion. Without distortion images come back
/// as they are, neither copied nor resampled. Copies share their tables, which are never written.
class Rectifier {
 public:
  explicit Rectifier(const CameraCalibration& calibration);

  /// True where there is no distortion to take out.
  bool isIdentity() const noexcept { return map_whole_.empty(); }

  const CameraCalibration& calibration() const noexcept { return calibration_; }

  /// Of the camera's images (px).
  cv::Size size() const noexcept { return {calibration_.width, calibration_.height}; }

  /// Rectified colour or grey image, linear interpolation; black where the camera did not look.
  /// @throws std::invalid_argument where the image is not of the calibration's size.
  cv::Mat color(const cv::Mat& image) const;

  /// Rectified depth image, nearest neighbour, so that no depth is made up between near and far;
  /// 0 where the camera did not look. Also for label images, of any type of one channel.
  /// @throws std::invalid_argument where the image is not of the calibration's size.
  cv::Mat depth(const cv::Mat& image) const;

  /// CV_8UC1 mask of the rectified image: 255 where the camera looked, else 0. The border between
  /// the two is an edge in color() that is none in the world.
  cv::Mat validMask() const;

  /// Smallest box in the rectified image around a box in the raw image (px). The part within the
  /// image counts, since the distortion model holds there; a box that is wholly outside, inverted
  /// or NaN comes back as it is.
  DetectionBox box(const DetectionBox& raw) const;

  /// The other way: smallest box in the raw image around a box in the rectified image (px).
  DetectionBox rawBox(const DetectionBox& rectified) const;

 private:
  template <class Map>
  DetectionBox mapped(const DetectionBox& from, const Map& map) const;
  void checkSize(const cv::Mat& image) const;

  CameraCalibration calibration_;
  cv::Mat map_whole_;     // CV_16SC2: raw pixel of a rectified one, whole part
  cv::Mat map_fraction_;  // CV_16UC1: its fraction, as cv::remap has it
  cv::Mat nearest_;       // CV_16SC2: raw pixel of a rectified one, rounded
};

}  // namespace hmcdyn::slam

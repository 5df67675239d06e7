// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include <hmcdyn/types.hpp>

namespace hmcdyn::slam {

/// What a detector saw in an image.
struct Seen {
  std::vector<DetectionBox> boxes;  ///< As detect() gives them.
  /// To the pixel what the boxes are around, as makeFrameMask() takes it; empty = boxes only.
  cv::Mat labels;
};

/// Finds objects in colour images. The same images in the same order give the same boxes, bit for
/// bit. An instance serves one thread at a time.
class ObjectDetector {
 public:
  ObjectDetector() = default;
  virtual ~ObjectDetector() = default;
  ObjectDetector(const ObjectDetector&) = delete;
  ObjectDetector& operator=(const ObjectDetector&) = delete;
  ObjectDetector(ObjectDetector&&) = delete;
  ObjectDetector& operator=(ObjectDetector&&) = delete;

  /// The objects in an image: COCO classes, pixels of the image, clipped to it, strongest first.
  /// @param bgr CV_8UC3; @param timestamp of the image (s).
  /// @throws std::invalid_argument where the image is empty or of another type.
  virtual std::vector<DetectionBox> detect(const cv::Mat& bgr, double timestamp) = 0;

  /// The same, with a mask where the detector makes one.
  virtual Seen see(const cv::Mat& bgr, double timestamp) { return {detect(bgr, timestamp), {}}; }

  /// What finds the boxes, for reports: "darknet yolo-fastest-1.1.cfg 320x320".
  virtual std::string name() const = 0;
};

}  // namespace hmcdyn::slam

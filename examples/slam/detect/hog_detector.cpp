// SPDX-License-Identifier: BSD-3-Clause
#include "slam/detect/hog_detector.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include <opencv2/objdetect.hpp>

#include "slam/detect/box_selection.hpp"

namespace hmcdyn::slam {
namespace {

class HogDetector final : public ObjectDetector {
 public:
  explicit HogDetector(DetectorOptions options) : options_(std::move(options)) {
    hog_.setSVMDetector(cv::HOGDescriptor::getDefaultPeopleDetector());
  }

  std::vector<DetectionBox> detect(const cv::Mat& bgr, double /*timestamp*/) override {
    checkColorImage(bgr);
    if (bgr.cols < hog_.winSize.width || bgr.rows < hog_.winSize.height) {
      return {};  // cv::HOGDescriptor reads outside such an image
    }
    std::vector<cv::Rect> people;
    std::vector<double> margins;
    constexpr double kMargin = 0.0;
    const cv::Size stride(8, 8);
    constexpr double kPyramidStep = 1.05;
    hog_.detectMultiScale(bgr, people, margins, kMargin, stride, cv::Size(), kPyramidStep);

    std::vector<DetectionBox> boxes;
    for (std::size_t i = 0; i < people.size(); ++i) {
      const cv::Rect2f person = people[i];
      boxes.push_back({person.x, person.y, person.x + person.width, person.y + person.height,
                       kPersonClassId, static_cast<float>(1.0 - std::exp(-margins[i]))});
    }
    boxes = clipToImage(keepWanted(boxes, options_), bgr.size());
    // OpenCV's threads hand in their windows in no fixed order.
    std::sort(boxes.begin(), boxes.end(), [](const DetectionBox& a, const DetectionBox& b) {
      return std::tie(b.score, a.x_min, a.y_min, a.x_max, a.y_max) <
             std::tie(a.score, b.x_min, b.y_min, b.x_max, b.y_max);
    });
    return boxes;
  }

  std::string name() const override { return "hog"; }

 private:
  cv::HOGDescriptor hog_;
  DetectorOptions options_;
};

}  // namespace

std::unique_ptr<ObjectDetector> makeHogDetector(const DetectorOptions& options) {
  return std::make_unique<HogDetector>(options);
}

}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#include "slam/detect/box_selection.hpp"

#include <algorithm>
#include <cstddef>
#include <map>
#include <stdexcept>

#include <fmt/format.h>
#include <opencv2/dnn/dnn.hpp>

namespace hmcdyn::slam {

void checkColorImage(const cv::Mat& bgr) {
  if (bgr.empty() || bgr.type() != CV_8UC3) {
    throw std::invalid_argument(
        fmt::format("detect: bgr is {} x {} pixels of type {}; expected an image of type CV_8UC3",
                    bgr.cols, bgr.rows, cv::typeToString(bgr.type())));
  }
}

std::vector<DetectionBox> keepWanted(const std::vector<DetectionBox>& boxes,
                                     const DetectorOptions& options) {
  std::vector<DetectionBox> kept;
  for (const DetectionBox& box : boxes) {
    const bool wanted = options.classes.empty() ||
                        std::find(options.classes.begin(), options.classes.end(), box.class_id) !=
                            options.classes.end();
    if (wanted && box.score >= options.score_threshold) {
      kept.push_back(box);
    }
  }
  return kept;
}

std::vector<DetectionBox> suppressOverlaps(const std::vector<DetectionBox>& boxes,
                                           float nms_threshold) {
  std::map<int, std::vector<std::size_t>> by_class;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    by_class[boxes[i].class_id].push_back(i);
  }
  std::vector<std::size_t> kept;
  for (const auto& [class_id, members] : by_class) {
    std::vector<cv::Rect2d> rectangles;
    std::vector<float> scores;
    for (const std::size_t i : members) {
      const DetectionBox& box = boxes[i];
      rectangles.emplace_back(cv::Point2d(box.x_min, box.y_min), cv::Point2d(box.x_max, box.y_max));
      scores.push_back(box.score);
    }
    std::vector<int> survivors;
    constexpr float kAboveNothing = 0.0f;  // the caller has applied its threshold
    cv::dnn::NMSBoxes(rectangles, scores, kAboveNothing, nms_threshold, survivors);
    for (const int survivor : survivors) {
      kept.push_back(members[static_cast<std::size_t>(survivor)]);
    }
  }
  std::sort(kept.begin(), kept.end());
  std::stable_sort(kept.begin(), kept.end(), [&](std::size_t left, std::size_t right) {
    return boxes[left].score > boxes[right].score;
  });
  std::vector<DetectionBox> result;
  result.reserve(kept.size());
  for (const std::size_t i : kept) {
    result.push_back(boxes[i]);
  }
  return result;
}

}  // namespace hmcdyn::slam

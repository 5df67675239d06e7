// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include <hmcdyn/frame_filter.hpp>

#include "layered_scene.hpp"

namespace hmcdyn::test {

/// Four frames of a person-sized thing that rises by 3 px a frame past three walls, which a moving
/// camera leaves behind by 1, 2 and 3 px a frame. Frame 3 is the one that LayeredScene tells the
/// truth about.
struct FilmedScene {
  static constexpr int kFrames = 4;
  /// At the usual pace F of all matches, those of the thing as well, explains the thing to a
  /// quarter of a pixel: three walls that pass by at 1 to 3 px say too little. At this one they say
  /// enough.
  static constexpr double kForAllMatches = 3.0;

  LayeredScene scene;
  KeyPoints points = LayeredScene::keyPoints();
  std::vector<cv::KeyPoint> key_points;
  std::vector<DetectionBox> boxes = {LayeredScene::boxOfThing()};

  /// @param pace of camera and thing, as a multiple of the above.
  explicit FilmedScene(double pace = 1.0)
      : scene(pace * LayeredScene::kUsualStep, pace * Eigen::Vector2d(1.0, -3.0)) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      key_points.emplace_back(points.u[i], points.v[i], 7.0f);
    }
  }

  /// @param frame 0 .. kFrames - 1.
  FrameInput input(int frame) const {
    FrameInput input;
    input.timestamp = frame / 30.0;
    input.gray = scene.grayOf(kFrames - 1 - frame);
    input.depth = scene.depthOf(kFrames - 1 - frame);
    input.key_points = key_points;
    return input;
  }

  /// A mask of the thing in the last frame: label 7.
  static cv::Mat maskOfThing() {
    cv::Mat labels = cv::Mat::zeros(LayeredScene::kHeight, LayeredScene::kWidth, CV_8UC1);
    for (int y = 0; y < labels.rows; ++y) {
      for (int x = 0; x < labels.cols; ++x) {
        labels.at<std::uint8_t>(y, x) = LayeredScene::isThing(x, y) ? 7 : 0;
      }
    }
    return labels;
  }

  bool isThing(std::size_t i) const { return LayeredScene::isThing(points.u[i], points.v[i]); }
};

/// -1 in place of each NaN, so that equal arrays compare equal. For values >= 0.
inline std::vector<float> withoutNaN(std::vector<float> values) {
  std::replace_if(
      values.begin(), values.end(), [](float value) { return std::isnan(value); }, -1.0f);
  return values;
}

/// The last frame's result after a film from `first` on.
template <class Regions>
FrameFilterResult filterFilm(FrameFilter& filter, const FilmedScene& film, const Regions& regions,
                             int first = 0) {
  FrameFilterResult result;
  for (int frame = first; frame < FilmedScene::kFrames; ++frame) {
    result = filter.filter(film.input(frame), regions);
  }
  return result;
}

}  // namespace hmcdyn::test

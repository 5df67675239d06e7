// SPDX-License-Identifier: BSD-3-Clause
#include "slam/run/filter_frame.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "drawn_texture.hpp"

namespace hmcdyn::slam {
namespace {

const PinholeCamera kCamera{300.0, 300.0, 159.5, 119.5};
constexpr int kLastStep = 10;  ///< The card moves up to this frame, and then stands.

cv::Rect cardAt(int frame) { return {20 + 12 * std::min(frame, kLastStep), 60, 80, 120}; }

/// A card 1 m away that slides before a wall, 3 m away, and stops; the camera stands. 30 Hz.
RgbdFrame imageAt(int frame) {
  static const cv::Mat wall = hmcdyn::test::makeTexture({320, 240}, 3);
  static const cv::Mat card = hmcdyn::test::makeTexture({80, 120}, 4);
  RgbdFrame image;
  image.timestamp = 10.0 + frame / 30.0;
  image.gray = wall.clone();
  image.depth = cv::Mat(240, 320, CV_32FC1, cv::Scalar(3.0));
  card.copyTo(image.gray(cardAt(frame)));
  image.depth(cardAt(frame)).setTo(1.0);
  return image;
}

Frame pointsOf(const RgbdFrame& image) {
  Features features;
  for (int v = 4; v < image.gray.rows; v += 8) {
    for (int u = 4; u < image.gray.cols; u += 8) {
      features.key_points.emplace_back(static_cast<float>(u), static_cast<float>(v), 7.0f);
    }
  }
  features.descriptors = cv::Mat::zeros(static_cast<int>(features.key_points.size()), 32, CV_8UC1);
  return makeFrame(0, image.timestamp, std::move(features), image.depth, 1.2f);
}

TEST(FilterFrame, WhatPausedWithoutABoxIsNoLandmark) {
  FrameFilterOptions options;
  options.camera = kCamera;
  FrameFilter filter(options);
  const Tracker tracker(kCamera, {});
  Frame frame;
  for (int k = 0; k <= kLastStep + 6; ++k) {
    const RgbdFrame image = imageAt(k);
    frame = pointsOf(image);
    filterFrame(image, {}, {}, tracker, filter, frame);
    filter.setPose(image.timestamp, Pose());
  }
  const cv::Rect card = cardAt(kLastStep);
  std::size_t standing = 0;
  for (std::size_t i = 0; i < frame.points.size(); ++i) {
    const cv::Point at(static_cast<int>(frame.points.u[i]), static_cast<int>(frame.points.v[i]));
    const bool inside =
        cv::Rect(card.x + 8, card.y + 8, card.width - 16, card.height - 16).contains(at);
    if (inside) {  // it stands, and may be matched, but not mapped
      EXPECT_EQ(frame.in_person[i], 1) << at;
      standing += frame.label[i] != PointLabel::kDynamic ? 1 : 0;
    } else if (at.x > card.br().x + 24) {  // where it never was
      EXPECT_EQ(frame.in_person[i], 0) << at;
    }
  }
  EXPECT_GT(standing, 20U);
}

}  // namespace
}  // namespace hmcdyn::slam

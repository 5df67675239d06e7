// SPDX-License-Identifier: BSD-3-Clause
#include "slam/input/camera/rectifier.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <Eigen/Core>
#include <gtest/gtest.h>

namespace hmcdyn::slam {
namespace {

// Raw pixel of a rectified one: the model of Brown and Conrady, written out.
Eigen::Vector2d distort(const CameraCalibration& camera, double u, double v) {
  const auto [k1, k2, p1, p2, k3] = camera.distortion;
  const double x = (u - camera.pinhole.cx) / camera.pinhole.fx;
  const double y = (v - camera.pinhole.cy) / camera.pinhole.fy;
  const double r2 = x * x + y * y;
  const double radial = 1.0 + k1 * r2 + k2 * r2 * r2 + k3 * r2 * r2 * r2;
  const double xd = x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x);
  const double yd = y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y;
  return {camera.pinhole.fx * xd + camera.pinhole.cx, camera.pinhole.fy * yd + camera.pinhole.cy};
}

// Rectified pixel of a raw one, by fixed-point iteration.
Eigen::Vector2d undistort(const CameraCalibration& camera, double u, double v) {
  const Eigen::Vector2d raw(u, v);
  Eigen::Vector2d rectified = raw;
  for (int i = 0; i < 200; ++i) {
    rectified += raw - distort(camera, rectified.x(), rectified.y());
  }
  EXPECT_LT((distort(camera, rectified.x(), rectified.y()) - raw).norm(), 1e-6);
  return rectified;
}

bool within(const CameraCalibration& camera, const Eigen::Vector2d& pixel, double margin) {
  return pixel.x() > margin && pixel.y() > margin && pixel.x() < camera.width - 1 - margin &&
         pixel.y() < camera.height - 1 - margin;
}

class DistortedCamera : public testing::TestWithParam<const char*> {
 protected:
  CameraCalibration camera = loadCamera(GetParam());
  Rectifier rectifier{camera};
};

TEST(UndistortedCamera, GivesBackImagesAndBoxesAsTheyAre) {
  const Rectifier rectifier(loadCamera("tum3"));
  EXPECT_TRUE(rectifier.isIdentity());
  const cv::Mat color(480, 640, CV_8UC3, cv::Scalar(1, 2, 3));
  const cv::Mat depth(480, 640, CV_32FC1, cv::Scalar(2));
  EXPECT_EQ(rectifier.color(color).data, color.data);
  EXPECT_EQ(rectifier.depth(depth).data, depth.data);
  EXPECT_EQ(cv::countNonZero(rectifier.validMask()), 640 * 480);
  const DetectionBox box = rectifier.box({-5.0f, 10.0f, 700.0f, 20.0f, 7, 0.5f});
  EXPECT_EQ(box.x_min, -5.0f);
  EXPECT_EQ(box.x_max, 700.0f);
}

TEST_P(DistortedCamera, ColourComesFromTheDistortedPixelLinearly) {
  // Given raw images whose value is their column, and their row, over 4 or 2.
  cv::Mat columns(camera.height, camera.width, CV_32FC1);
  cv::Mat rows(camera.height, camera.width, CV_32FC1);
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      columns.at<float>(v, u) = static_cast<float>(u);
      rows.at<float>(v, u) = static_cast<float>(v);
    }
  }
  const cv::Mat raw_u = rectifier.color(columns);
  const cv::Mat raw_v = rectifier.color(rows);
  // Then a rectified pixel holds the position it came from, to cv::remap's 1/32 px.
  for (int v = 0; v < camera.height; v += 7) {
    for (int u = 0; u < camera.width; u += 7) {
      const Eigen::Vector2d raw = distort(camera, u, v);
      if (within(camera, raw, 1.0)) {
        ASSERT_NEAR(raw_u.at<float>(v, u), raw.x(), 1.0 / 32.0) << u << " " << v;
        ASSERT_NEAR(raw_v.at<float>(v, u), raw.y(), 1.0 / 32.0) << u << " " << v;
      }
    }
  }
}

TEST_P(DistortedCamera, DepthComesFromTheNearestPixelAndIsNeverMixed) {
  // Given a raw depth image that alternates between near and far.
  cv::Mat depth(camera.height, camera.width, CV_32FC1);
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      depth.at<float>(v, u) = (u + v) % 2 == 0 ? 1.0f : 4.0f;
    }
  }
  const cv::Mat rectified = rectifier.depth(depth);
  const cv::Mat valid = rectifier.validMask();
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const Eigen::Vector2d raw = distort(camera, u, v);
      const float found = rectified.at<float>(v, u);
      const double column = std::round(raw.x());
      const double row = std::round(raw.y());
      const bool clear = std::abs(std::abs(raw.x() - column) - 0.5) > 0.01 &&
                         std::abs(std::abs(raw.y() - row) - 0.5) > 0.01;
      if (!clear) {
        continue;  // between two pixels, rounding may go either way
      }
      const bool inside = column >= 0 && row >= 0 && column < camera.width && row < camera.height;
      const bool near = (static_cast<long>(column) + static_cast<long>(row)) % 2 == 0;
      ASSERT_EQ(found, inside ? (near ? 1.0f : 4.0f) : 0.0f) << u << " " << v;
      ASSERT_EQ(valid.at<std::uint8_t>(v, u), inside ? 255 : 0) << u << " " << v;
    }
  }
}

TEST_P(DistortedCamera, ABoxHoldsWhatItHeldAndNoMore) {
  const DetectionBox raw{40.0f, 200.0f, 240.0f, 470.0f, 7, 0.5f};
  const DetectionBox box = rectifier.box(raw);
  EXPECT_EQ(box.class_id, 7);
  EXPECT_EQ(box.score, 0.5f);
  // The extremes over a dense grid of raw pixels in the box are its borders.
  Eigen::Vector2d least(1e9, 1e9);
  Eigen::Vector2d most(-1e9, -1e9);
  for (int v = 200; v <= 470; v += 2) {
    for (int u = 40; u <= 240; u += 2) {
      const Eigen::Vector2d rectified = undistort(camera, u, v);
      least = least.cwiseMin(rectified);
      most = most.cwiseMax(rectified);
    }
  }
  EXPECT_NEAR(box.x_min, least.x(), 0.05);
  EXPECT_NEAR(box.y_min, least.y(), 0.05);
  EXPECT_NEAR(box.x_max, most.x(), 0.05);
  EXPECT_NEAR(box.y_max, most.y(), 0.05);
}

TEST_P(DistortedCamera, ARawBoxIsTheSmallestAroundTheBentBorder) {
  const DetectionBox box{200.0f, 150.0f, 420.0f, 330.0f, 7, 0.5f};
  Eigen::Vector2d low(1e9, 1e9);
  Eigen::Vector2d high(-1e9, -1e9);
  const auto cover = [&](double u, double v) {
    const Eigen::Vector2d raw = distort(camera, u, v);
    low = low.cwiseMin(raw);
    high = high.cwiseMax(raw);
  };
  for (int u = 200; u <= 420; ++u) {
    cover(u, box.y_min);
    cover(u, box.y_max);
  }
  for (int v = 150; v <= 330; ++v) {
    cover(box.x_min, v);
    cover(box.x_max, v);
  }
  const DetectionBox raw = rectifier.rawBox(box);
  // The border is mapped at some of its points; between them it bends by less than this.
  EXPECT_NEAR(raw.x_min, low.x(), 0.1);
  EXPECT_NEAR(raw.y_min, low.y(), 0.1);
  EXPECT_NEAR(raw.x_max, high.x(), 0.1);
  EXPECT_NEAR(raw.y_max, high.y(), 0.1);
  EXPECT_EQ(raw.class_id, 7);
  EXPECT_EQ(raw.score, 0.5f);
}

TEST_P(DistortedCamera, OfABoxThatReachesOutsideTheImagePartCounts) {
  const DetectionBox image = rectifier.box({0.0f, 0.0f, 639.0f, 479.0f});
  const DetectionBox larger = rectifier.box({-4000.0f, -4000.0f, 4000.0f, 4000.0f});
  EXPECT_EQ(larger.x_min, image.x_min);
  EXPECT_EQ(larger.y_min, image.y_min);
  EXPECT_EQ(larger.x_max, image.x_max);
  EXPECT_EQ(larger.y_max, image.y_max);
  EXPECT_TRUE(std::isfinite(image.x_min) && std::isfinite(image.x_max));
}

TEST_P(DistortedCamera, BoxesWithoutAPixelComeBackAsTheyAre) {
  const DetectionBox inverted = rectifier.box({100.0f, 10.0f, 50.0f, 20.0f});
  EXPECT_EQ(inverted.x_min, 100.0f);
  EXPECT_EQ(inverted.x_max, 50.0f);
  const DetectionBox outside = rectifier.box({700.0f, 10.0f, 800.0f, 20.0f});
  EXPECT_EQ(outside.x_min, 700.0f);
  const DetectionBox nan = rectifier.box({kNaN, 10.0f, 50.0f, 20.0f});
  EXPECT_TRUE(std::isnan(nan.x_min));
  EXPECT_EQ(nan.x_max, 50.0f);
}

TEST_P(DistortedCamera, AnotherSizeIsTheCallersMistake) {
  EXPECT_THROW(rectifier.color(cv::Mat(240, 320, CV_8UC3)), std::invalid_argument);
  EXPECT_THROW(rectifier.depth(cv::Mat(480, 639, CV_32FC1)), std::invalid_argument);
}

INSTANTIATE_TEST_SUITE_P(Presets, DistortedCamera, testing::Values("tum1", "tum2", "bonn"),
                         [](const auto& param) { return std::string(param.param); });

}  // namespace
}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#include "calibrate/depth_to_color.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace hmcdyn::calibrate {
namespace {

constexpr int kWidth = 320;
constexpr int kHeight = 240;

/// A wavy wall, seen by colour: its depth (m) at a pixel.
double wallDepth(double u, double v) {
  return 2.0 + 0.25 * std::sin(u / 9.0) + 0.25 * std::cos(v / 7.0);
}

struct Recording {
  std::vector<CalibrationImage> images;
  std::vector<DepthSample> samples;
};

/// Images whose depth shows what colour shows `shift` beside, `delay` (s) later, while the camera
/// goes sideways, down, or the other way (px/s).
Recording recordingOf(cv::Point2d shift, double delay, double speed) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  Recording recording;
  for (int i = 0; i < 4; ++i) {
    const double flow_u = speed * (i % 2 == 0 ? 1.0 : -1.0);
    const double flow_v = speed * (i < 2 ? 1.0 : -1.0);
    CalibrationImage image;
    image.depth.create(kHeight, kWidth, CV_32FC1);
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) {
        // What is at u when depth is taken was at u - flow * delay with the colour.
        image.depth.at<float>(v, u) = static_cast<float>(
            wallDepth(u + shift.x - delay * flow_u, v + shift.y - delay * flow_v));
      }
    }
    recording.images.push_back(image);
    for (int k = 0; k < 300; ++k) {
      DepthSample s;
      s.track = 300 * i + k;
      s.image = i;
      s.u = 20.0 + unit(random) * (kWidth - 40.0);
      s.v = 20.0 + unit(random) * (kHeight - 40.0);
      s.truth = wallDepth(s.u, s.v);
      s.measured = s.truth;
      s.flow_u = flow_u;
      s.flow_v = flow_v;
      recording.samples.push_back(s);
    }
  }
  return recording;
}

TEST(DepthToColor, FindsAShift) {
  const Recording r = recordingOf({1.3, -0.7}, 0.0, 60.0);
  const DepthToColor found = depthToColor(r.images, r.samples, {}, 1.0, 0.02);
  ASSERT_TRUE(found.shift_u.observable);
  ASSERT_TRUE(found.shift_v.observable);
  EXPECT_NEAR(found.shift_u.value, 1.3, 0.15);
  EXPECT_NEAR(found.shift_v.value, -0.7, 0.15);
  EXPECT_GT(found.samples, 1000U);
}

TEST(DepthToColor, FindsADelayWhereTheCameraMoves) {
  const Recording r = recordingOf({0.0, 0.0}, 0.012, 200.0);
  const DepthToColor found = depthToColor(r.images, r.samples, {}, 1.0, 0.02);
  ASSERT_TRUE(found.delay.observable);
  EXPECT_NEAR(found.delay.value, 0.012, 0.001);
  EXPECT_NEAR(found.shift_u.value, 0.0, 0.15);
}

TEST(DepthToColor, ADelayOfAStillCameraIsNotObservable) {
  const Recording r = recordingOf({1.0, 0.0}, 0.012, 0.0);
  const DepthToColor found = depthToColor(r.images, r.samples, {}, 1.0, 0.02);
  EXPECT_FALSE(found.delay.observable);
  EXPECT_TRUE(found.shift_u.observable);
}

TEST(DepthToColor, AFlatWallTellsNothing) {
  Recording r = recordingOf({1.0, 0.0}, 0.0, 60.0);
  for (CalibrationImage& image : r.images) {
    image.depth.setTo(2.0f);
  }
  const DepthToColor found = depthToColor(r.images, r.samples, {}, 1.0, 0.02);
  EXPECT_EQ(found.samples, 0U);
  EXPECT_FALSE(found.shift_u.observable);
  EXPECT_FALSE(found.shift_v.observable);
  EXPECT_FALSE(found.delay.observable);
}

TEST(DepthToColor, AShiftBeyondTheSearchIsNotObservable) {
  const Recording r = recordingOf({4.5, 0.0}, 0.0, 60.0);
  EXPECT_FALSE(depthToColor(r.images, r.samples, {}, 1.0, 0.02).shift_u.observable);
}

}  // namespace
}  // namespace hmcdyn::calibrate

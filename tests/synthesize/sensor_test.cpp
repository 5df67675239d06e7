// SPDX-License-Identifier: BSD-3-Clause
#include "synthesize/sensor.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace hmcdyn::synthesize {
namespace {

constexpr int kWidth = 160;
constexpr int kHeight = 120;

/// A grey wall across the view at a depth (m).
RenderedFrame wallAt(float depth, int grey = 120, float facing = 1.0f) {
  RenderedFrame frame;
  const cv::Size size(kWidth, kHeight);
  frame.color = cv::Mat(size, CV_8UC3, cv::Scalar(grey, grey, grey));
  frame.depth = cv::Mat(size, CV_32FC1, cv::Scalar(depth));
  frame.facing = cv::Mat(size, CV_32FC1, cv::Scalar(facing));
  frame.mask = cv::Mat::zeros(size, CV_8UC1);
  frame.mover = cv::Mat(size, CV_16SC1, cv::Scalar(-1));
  return frame;
}

Sensor sensorOf(NoiseModel model, const KinectOptions& options = {}) {
  return Sensor(model, options, {kWidth, kHeight}, 7);
}

struct DepthStatistics {
  double mean = 0.0;
  double deviation = 0.0;
  double share = 0.0;  ///< Of pixels with depth.
};

DepthStatistics statisticsOf(const cv::Mat& depth) {
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(depth, mean, deviation, depth > 0);
  return {mean[0] / kDepthFactor, deviation[0] / kDepthFactor,
          static_cast<double>(cv::countNonZero(depth)) / static_cast<double>(depth.total())};
}

TEST(Sensor, WithoutNoiseDepthIsRoundedToTheFilesUnitAndColourUntouched) {
  const RenderedFrame frame = wallAt(1.23456f);
  const SensorFrame measured = sensorOf(NoiseModel::kNone).measure(frame, 0, 0.0);
  EXPECT_EQ(measured.depth.at<std::uint16_t>(5, 5), 6173);  // 1.23456 * 5000 = 6172.8
  EXPECT_EQ(cv::norm(measured.color, frame.color, cv::NORM_INF), 0.0);
}

TEST(Sensor, WithoutNoiseDepthBeyondTheFilesRangeIsNone) {
  const Sensor sensor = sensorOf(NoiseModel::kNone);
  EXPECT_EQ(sensor.measure(wallAt(13.0f), 0, 0.0).depth.at<std::uint16_t>(0, 0), 65000);
  EXPECT_EQ(sensor.measure(wallAt(13.2f), 0, 0.0).depth.at<std::uint16_t>(0, 0), 0);
  EXPECT_EQ(sensor.measure(wallAt(0.0f), 0, 0.0).depth.at<std::uint16_t>(0, 0), 0);
}

TEST(Sensor, DepthNoiseGrowsWithTheSquareOfTheDistance) {
  // Without steps of disparity what is left is 0.0012 + 0.0019 (z - 0.4)^2.
  KinectOptions options;
  options.disparity_step = 1e-6;
  const Sensor sensor = sensorOf(NoiseModel::kKinect, options);
  for (const double z : {1.0, 2.0, 3.0, 4.0}) {
    const DepthStatistics s =
        statisticsOf(sensor.measure(wallAt(static_cast<float>(z)), 0, 0.0).depth);
    const double expected = 0.0012 + 0.0019 * (z - 0.4) * (z - 0.4);
    EXPECT_NEAR(s.deviation, expected, 0.15 * expected) << "at " << z << " m";
    EXPECT_NEAR(s.mean, z, 0.1 * expected + 0.0002) << "at " << z << " m";
    EXPECT_DOUBLE_EQ(s.share, 1.0) << "at " << z << " m";
  }
}

TEST(Sensor, DepthComesInStepsOfDisparity) {
  // At 3 m a step of 1/8 px is z^2 / (8 * 43.5) = 26 mm.
  KinectOptions options;
  options.axial_base = 0.0;
  options.axial_growth = 0.0;
  const SensorFrame measured = sensorOf(NoiseModel::kKinect, options).measure(wallAt(3.0f), 0, 0.0);
  const double disparity = std::round(43.5 / 3.0 * 8.0) / 8.0;
  EXPECT_EQ(measured.depth.at<std::uint16_t>(9, 9), std::lround(43.5 / disparity * 5000.0));
  EXPECT_NEAR(statisticsOf(measured.depth).deviation, 0.0, 1e-9);
}

TEST(Sensor, TooNearTooFarGrazingAndDarkSurfacesHaveNoDepth) {
  const Sensor sensor = sensorOf(NoiseModel::kKinect);
  EXPECT_EQ(statisticsOf(sensor.measure(wallAt(0.45f), 0, 0.0).depth).share, 0.0);
  EXPECT_EQ(statisticsOf(sensor.measure(wallAt(5.1f), 0, 0.0).depth).share, 0.0);
  EXPECT_EQ(statisticsOf(sensor.measure(wallAt(2.0f, 120, 0.1f), 0, 0.0).depth).share, 0.0);
  EXPECT_NEAR(statisticsOf(sensor.measure(wallAt(2.0f, 16), 0, 0.0).depth).share, 0.5, 0.05);
  EXPECT_LT(statisticsOf(sensor.measure(wallAt(2.0f, 2), 0, 0.0).depth).share, 0.02);
  EXPECT_EQ(statisticsOf(sensor.measure(wallAt(2.0f, 60), 0, 0.0).depth).share, 1.0);
}

TEST(Sensor, ForegroundCastsAShadowInDepthOnItsLeft) {
  // Projector to the right: at 1 m against 4 m the shadow is 43.5 (1 - 1/4) = 33 px wide.
  RenderedFrame frame = wallAt(4.0f);
  frame.depth.colRange(80, 120).setTo(1.0f);
  const cv::Mat depth = sensorOf(NoiseModel::kKinect).measure(frame, 0, 0.0).depth;
  const auto share = [&](int first, int last) {
    const cv::Mat part = depth.colRange(first, last);
    return static_cast<double>(cv::countNonZero(part)) / static_cast<double>(part.total());
  };
  EXPECT_DOUBLE_EQ(share(0, 42), 1.0);
  EXPECT_LT(share(52, 74), 0.02);
  EXPECT_DOUBLE_EQ(share(88, 112), 1.0);
  EXPECT_DOUBLE_EQ(share(126, 160), 1.0);
}

TEST(Sensor, ColourNoiseHasTheStatedVariance) {
  KinectOptions options;
  options.vignetting = 0.0;
  options.exposure_swing = 0.0;
  const SensorFrame measured =
      sensorOf(NoiseModel::kKinect, options).measure(wallAt(2.0f, 100), 0, 0.0);
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(measured.color, mean, deviation);
  // Variance 1.1^2 + 0.025 * 100, and 1/12 from rounding.
  const double expected = std::sqrt(1.1 * 1.1 + 2.5 + 1.0 / 12.0);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(mean[c], 100.0, 0.6);
    EXPECT_NEAR(deviation[c], expected, 0.1);
  }
}

TEST(Sensor, ExposureDriftsSlowlyAndWithinItsSwing) {
  KinectOptions options;
  options.vignetting = 0.0;
  const Sensor sensor = sensorOf(NoiseModel::kKinect, options);
  double low = 255.0;
  double high = 0.0;
  double previous = -1.0;
  for (int i = 0; i < 300; ++i) {
    const double time = i / 30.0;
    const double mean = cv::mean(sensor.measure(wallAt(2.0f, 100), 3, time).color)[1];
    low = std::min(low, mean);
    high = std::max(high, mean);
    if (previous >= 0.0) {
      ASSERT_LT(std::abs(mean - previous), 1.2);
    }
    previous = mean;
  }
  EXPECT_GT(high - low, 4.0);
  EXPECT_LT(high - low, 2.0 * 7.0 + 2.0);
}

TEST(Sensor, SameFrameNumberSameNoiseOtherNumberOtherNoise) {
  const Sensor a = sensorOf(NoiseModel::kKinect);
  const Sensor b = sensorOf(NoiseModel::kKinect);
  const RenderedFrame frame = wallAt(2.0f);
  const SensorFrame first = a.measure(frame, 4, 0.0);
  a.measure(frame, 5, 0.0);
  const SensorFrame again = b.measure(frame, 4, 0.0);
  EXPECT_EQ(cv::norm(first.color, again.color, cv::NORM_INF), 0.0);
  EXPECT_EQ(cv::norm(first.depth, again.depth, cv::NORM_INF), 0.0);
  EXPECT_GT(cv::norm(first.color, a.measure(frame, 5, 0.0).color, cv::NORM_INF), 0.0);
}

}  // namespace
}  // namespace hmcdyn::synthesize

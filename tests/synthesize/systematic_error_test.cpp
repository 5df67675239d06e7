// SPDX-License-Identifier: BSD-3-Clause
#include "synthesize/systematic_error.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include "synthesize/sensor.hpp"
#include "synthesize/sequence.hpp"
#include "test_scenes.hpp"

namespace hmcdyn::synthesize {
namespace {

const cv::Size kImage(160, 120);

double rmsOf(const cv::Mat& field) {
  return cv::norm(field) / std::sqrt(static_cast<double>(field.total()));
}

TEST(SystematicError, QuadraticPartHasTheStatedRmsWithEverySeed) {
  SystematicErrorOptions options;
  options.quadratic = 0.012;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    EXPECT_NEAR(rmsOf(drawSystematicError(options, kImage, seed).quadratic), 0.012, 1e-6) << seed;
  }
}

TEST(SystematicError, QuadraticPartChangesSmoothlyOverTheImage) {
  // A cosine of two half waves over 160 pixels changes by at most 2 pi / 160 of its amplitude from
  // one pixel to the next; so does a sum of cosines, of the sum of their amplitudes. With one of
  // them alone that is sqrt(2) 2 pi / 160 = 0.056 of the RMS, and a field that is rough by a
  // pixel changes by more than its RMS.
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const cv::Mat field = drawSystematicError({}, kImage, seed).quadratic;
    cv::Mat step;
    cv::absdiff(field.colRange(1, field.cols), field.colRange(0, field.cols - 1), step);
    double largest = 0.0;
    cv::minMaxLoc(step, nullptr, &largest);
    EXPECT_LT(largest, 0.1 * rmsOf(field)) << seed;
    EXPECT_GT(largest, 0.0) << seed;
  }
}

TEST(SystematicError, ScaleErrorsOfManySeedsHaveTheStatedDeviation) {
  // The deviation of 400 normal numbers is good to 1 / sqrt(800) = 3.5 %; three times that.
  SystematicErrorOptions options;
  options.scale = 0.01;
  double sum = 0.0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    const double scale = drawSystematicError(options, {16, 12}, seed).scale;
    sum += scale * scale;
  }
  EXPECT_NEAR(std::sqrt(sum / 400.0), 0.01, 0.00106);
}

TEST(SystematicError, ShiftIsAsLongAsStatedAndPointsAnywhere) {
  int quadrants = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const cv::Point2d shift = drawSystematicError({}, {16, 12}, seed).shift;
    EXPECT_GE(cv::norm(shift), 0.3 - 1e-9);
    EXPECT_LE(cv::norm(shift), 2.0 + 1e-9);
    quadrants |= 1 << ((shift.x > 0.0 ? 1 : 0) + (shift.y > 0.0 ? 2 : 0));
  }
  EXPECT_EQ(quadrants, 15);
}

TEST(SystematicError, SameSeedSameCameraOtherSeedOther) {
  const SystematicError first = drawSystematicError({}, kImage, 5);
  const SystematicError again = drawSystematicError({}, kImage, 5);
  const SystematicError other = drawSystematicError({}, kImage, 6);
  EXPECT_EQ(first.scale, again.scale);
  EXPECT_EQ(first.shift, again.shift);
  EXPECT_EQ(cv::norm(first.quadratic, again.quadratic, cv::NORM_INF), 0.0);
  EXPECT_NE(first.scale, other.scale);
  EXPECT_GT(cv::norm(first.quadratic, other.quadratic, cv::NORM_INF), 0.0);
}

TEST(SystematicError, BiasIsScaleAndSquareOfTheDepth) {
  SystematicError error;
  error.scale = -0.01;
  error.quadratic = cv::Mat(2, 2, CV_32FC1, cv::Scalar(0.0));
  error.quadratic.at<float>(1, 0) = 0.005f;
  EXPECT_NEAR(error.biased(2.0, 1, 0), 1.98, 1e-9);
  EXPECT_NEAR(error.biased(2.0, 0, 1), 2.0, 1e-8);  // 2 - 0.02 + 0.005 * 4
}

TEST(SystematicError, RefusesOptionsOutOfRange) {
  const auto draw = [](const SystematicErrorOptions& options) {
    drawSystematicError(options, kImage, 1);
  };
  SystematicErrorOptions options;
  options.scale = -0.1;
  EXPECT_THROW(draw(options), std::invalid_argument);
  options = {};
  options.quadratic = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(draw(options), std::invalid_argument);
  options = {};
  options.shift_least = 3.0;  // above the largest
  EXPECT_THROW(draw(options), std::invalid_argument);
}

/// A grey wall across the view at a depth (m), with a step of 1 m at half its width if wanted.
RenderedFrame biasedWallAt(float depth, float right_half) {
  RenderedFrame frame;
  frame.color = cv::Mat(kImage, CV_8UC3, cv::Scalar(120, 120, 120));
  frame.depth = cv::Mat(kImage, CV_32FC1, cv::Scalar(depth));
  frame.depth.colRange(kImage.width / 2, kImage.width).setTo(right_half);
  frame.facing = cv::Mat(kImage, CV_32FC1, cv::Scalar(1.0));
  return frame;
}

TEST(SystematicError, SensorsMeanDepthIsTheBiasedOne) {
  // Given a wall at 2 m, when 40 frames are averaged, then each pixel is as wrong as was drawn: the
  // noise of 7 mm is 1.1 mm then, of 19200 pixels the worst within five deviations.
  KinectOptions options;
  options.disparity_step = 1e-6;
  const Sensor sensor(NoiseModel::kKinectSystematic, options, kImage, 3);
  const RenderedFrame frame = biasedWallAt(2.0f, 2.0f);
  cv::Mat sum = cv::Mat::zeros(kImage, CV_64FC1);
  for (std::uint64_t i = 0; i < 40; ++i) {
    cv::Mat depth;
    sensor.measure(frame, i, 0.0).depth.convertTo(depth, CV_64F, 1.0 / kDepthFactor / 40.0);
    sum += depth;
  }
  for (int v = 0; v < kImage.height; v += 7) {
    for (int u = 0; u < kImage.width; u += 7) {
      EXPECT_NEAR(sum.at<double>(v, u), sensor.systematicError().biased(2.0, u, v), 0.006);
    }
  }
}

TEST(SystematicError, SensorsDepthLiesBesideTheColourByTheShift) {
  // Given a step from 2 m to 3 m at column 80 and a camera whose depth shows what lies 2 px to one
  // side, the step moves by -2 cos(direction) px.
  KinectOptions options;
  options.lateral = 0.0;
  options.systematic = {0.0, 0.0, 2.0, 2.0};
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
    const Sensor sensor(NoiseModel::kKinectSystematic, options, kImage, seed);
    const cv::Mat depth = sensor.measure(biasedWallAt(2.0f, 3.0f), 0, 0.0).depth;
    int first_far = 0;
    while (first_far < kImage.width &&
           depth.at<std::uint16_t>(60, first_far) < 2.5 * kDepthFactor) {
      ++first_far;
    }
    // Holes at the step hide a pixel or two of it on either side.
    EXPECT_NEAR(first_far, 80.0 - sensor.systematicError().shift.x, 2.0) << seed;
  }
}

TEST(SystematicError, OtherSensorsHaveNone) {
  for (const NoiseModel model : {NoiseModel::kNone, NoiseModel::kKinect}) {
    const Sensor sensor(model, {}, kImage, 3);
    EXPECT_EQ(sensor.systematicError().biased(2.0, 5, 5), 2.0);
    EXPECT_EQ(cv::norm(sensor.systematicError().shift), 0.0);
  }
}

TEST(SystematicError, SequenceFolderTellsTheTruth) {
  const test::TemporaryFolder folder;
  SequenceOptions options = test::shortSequence(folder / "out");
  options.noise = NoiseModel::kKinectSystematic;
  options.frames = 1;
  writeSequence(options);
  const YAML::Node file = YAML::LoadFile((options.output / "sensor.yaml").string());
  const SystematicError truth =
      drawSystematicError({}, {options.width, options.height}, options.seed);
  EXPECT_NEAR(file["scale_error"].as<double>(), truth.scale, 1e-8);
  EXPECT_NEAR(file["registration_shift"][0].as<double>(), truth.shift.x, 1e-7);
  EXPECT_NEAR(file["registration_shift"][1].as<double>(), truth.shift.y, 1e-7);
  const YAML::Node grid = file["quadratic_error"];
  const auto values = grid["values"].as<std::vector<float>>();
  const auto columns = grid["columns"].as<std::size_t>();
  ASSERT_EQ(values.size(), grid["rows"].as<std::size_t>() * columns);
  EXPECT_NEAR(values.front(), truth.quadratic.at<float>(0, 0), 1e-7);
  EXPECT_NEAR(values[columns - 1], truth.quadratic.at<float>(0, options.width - 1), 1e-7);
  EXPECT_NEAR(values.back(), truth.quadratic.at<float>(options.height - 1, options.width - 1),
              1e-7);

  options.noise = NoiseModel::kKinect;
  options.overwrite = true;
  writeSequence(options);
  EXPECT_FALSE(std::filesystem::exists(options.output / "sensor.yaml"));
}

}  // namespace
}  // namespace hmcdyn::synthesize

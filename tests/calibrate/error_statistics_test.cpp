// SPDX-License-Identifier: BSD-3-Clause
#include "calibrate/error_statistics.hpp"

#include <cmath>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

namespace hmcdyn::calibrate {
namespace {

/// Points whose depths share an error in all their images, and have noise of their own in each.
struct Recorded {
  std::vector<DepthSample> samples;
  std::vector<double> depths;
};

Recorded recorded(const DepthErrorModel& model, double near, double far, int tracks) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::normal_distribution<double> normal;
  Recorded result;
  for (int track = 0; track < tracks; ++track) {
    DepthSample s;
    s.track = track;
    s.u = 640.0 * unit(random);
    s.v = 480.0 * unit(random);
    s.truth = near + (far - near) * unit(random);
    const double shared = systematicDepthError(s.truth, model) * normal(random);
    for (int image = 0; image < 6; ++image) {
      s.image = image;
      s.measured = s.truth + shared + depthNoise(s.truth, model) * normal(random);
      result.samples.push_back(s);
      result.depths.push_back(s.measured);
    }
  }
  return result;
}

TEST(ErrorStatistics, NoiseAndSystematicErrorAreToldApart) {
  // Deviations of some thousand numbers are good to a few per cent.
  const DepthErrorModel truth{0.002f, 0.003f, 0.0f, 0.008f};
  const Recorded r = recorded(truth, 0.5, 4.0, 6000);
  const ErrorStatistics statistics = errorStatistics(r.samples, r.depths, 1.0, {640, 480});
  ASSERT_EQ(statistics.ranges.size(), 7U);
  for (const RangeStatistics& range : statistics.ranges) {
    EXPECT_NEAR(range.noise, depthNoise(range.middle, truth), 0.08 * range.noise) << range.middle;
    EXPECT_NEAR(range.systematic, systematicDepthError(range.middle, truth),
                0.12 * range.systematic)
        << range.middle;
    EXPECT_NEAR(range.bias, 0.0, 0.1 * range.total);
  }
  const DepthErrorModel model = fitModel(statistics.ranges);
  for (const float z : {1.0f, 2.0f, 3.5f}) {
    EXPECT_NEAR(depthNoise(z, model), depthNoise(z, truth), 0.08f * depthNoise(z, truth));
    EXPECT_NEAR(systematicDepthError(z, model), systematicDepthError(z, truth),
                0.12f * systematicDepthError(z, truth));
  }
}

TEST(ErrorStatistics, TriangulationsOwnErrorIsNotTheCameras) {
  // Given a perfect depth and a truth that is wrong by 10 mm, which it admits.
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::vector<DepthSample> samples;
  std::vector<double> depths;
  for (int track = 0; track < 2000; ++track) {
    const double wrong = 0.010 * normal(random);
    for (int image = 0; image < 3; ++image) {
      DepthSample s;
      s.track = track;
      s.image = image;
      s.truth = 2.25 + wrong;
      s.sigma = 0.010;
      samples.push_back(s);
      depths.push_back(2.25);
    }
  }
  const ErrorStatistics statistics = errorStatistics(samples, depths, 1.0, {640, 480});
  ASSERT_EQ(statistics.ranges.size(), 1U);
  EXPECT_NEAR(statistics.ranges[0].total, 0.010, 0.0005);
  EXPECT_LT(statistics.ranges[0].systematic, 0.004);  // sqrt(2 * 0.0005 * 0.010) = 0.003
}

TEST(ErrorStatistics, BiasOfEachThirdOfTheImageIsItsOwn) {
  std::vector<DepthSample> samples;
  std::vector<double> depths;
  for (int i = 0; i < 900; ++i) {
    DepthSample s;
    s.track = i;
    s.u = 640.0 * (i % 30 + 0.5) / 30.0;
    s.v = 480.0 * (i / 30 + 0.5) / 30.0;
    s.truth = 2.0;
    samples.push_back(s);
    depths.push_back(s.u < 213.0 ? 2.02 : 2.0);
    s.at_edge = true;  // what is behind, or before, is no error of the camera's field
    samples.insert(samples.end(), 2, s);
    depths.insert(depths.end(), 2, 2.6);
  }
  const ErrorStatistics statistics = errorStatistics(samples, depths, 1.0, {640, 480});
  EXPECT_EQ(statistics.edges, 1800U);
  ASSERT_EQ(statistics.regions.size(), 9U);
  for (const RegionStatistics& region : statistics.regions) {
    EXPECT_NEAR(region.bias, region.column == 0 ? 0.01 : 0.0, 1e-9);
    EXPECT_EQ(region.count, 100U);
  }
}

TEST(ErrorStatistics, TruthsScaleIsApplied) {
  DepthSample s;
  s.truth = 2.0;
  const std::vector<DepthSample> samples(100, s);
  const std::vector<double> depths(100, 2.2);
  StatisticsOptions options;
  options.least_count = 50;
  const ErrorStatistics statistics = errorStatistics(samples, depths, 1.1, {640, 480}, options);
  ASSERT_EQ(statistics.regions.size(), 1U);
  EXPECT_NEAR(statistics.regions[0].bias, 0.0, 1e-12);
}

TEST(ErrorStatistics, ModelHasNoNegativeParts) {
  // Noise that falls with the distance: a floor alone, the mean weighted by 1 / total^2,
  // (3 / 10^2 + 1 / 40^2) / (1 / 10^2 + 1 / 40^2) mm = 2.882 mm.
  RangeStatistics near;
  near.middle = 1.0;
  near.noise = 0.003;
  near.systematic = 0.010;
  near.total = 0.010;
  RangeStatistics far;
  far.middle = 2.0;
  far.noise = 0.001;
  far.systematic = 0.040;
  far.total = 0.040;
  const DepthErrorModel model = fitModel({near, far});
  EXPECT_NEAR(model.noise_floor, 0.002882f, 1e-6f);
  EXPECT_EQ(model.noise_quadratic, 0.0f);
  EXPECT_NEAR(model.systematic_quadratic, 0.010f, 1e-7f);
  EXPECT_NEAR(model.systematic_linear, 0.0f, 1e-7f);
}

TEST(ErrorStatistics, ARangeWhoseSystematicErrorDrownsDoesNotSilenceTheOthers) {
  // Given three ranges with 0.01 z^2 and one, the farthest, where noise is all there is: a z + b
  // z^2 in units of 0.01 z^2 fits (1, 1, 1, 0) best with a = 0.008 and b = 1 / 300.
  std::vector<RangeStatistics> ranges(4);
  for (std::size_t i = 0; i < 4; ++i) {
    const double z = 1.0 + static_cast<double>(i);
    ranges[i].middle = z;
    ranges[i].noise = i == 3 ? 0.16 : 0.0;
    ranges[i].systematic = i == 3 ? 0.0 : 0.010 * z * z;
    ranges[i].total = 0.010 * z * z;
  }
  const DepthErrorModel model = fitModel(ranges);
  EXPECT_NEAR(model.systematic_linear, 0.008f, 1e-6f);
  EXPECT_NEAR(model.systematic_quadratic, 1.0f / 300.0f, 1e-6f);
}

TEST(ErrorStatistics, WithoutARangeThereIsNoModel) {
  EXPECT_THROW(fitModel({}), std::runtime_error);
}

TEST(ErrorStatistics, PercentileOfNothingIsZero) {
  EXPECT_EQ(percentile({}, 0.5), 0.0);
  EXPECT_EQ(percentile({3.0, 1.0, 2.0}, 0.5), 2.0);
  EXPECT_EQ(percentile({3.0, 1.0, 2.0}, 1.0), 3.0);
}

}  // namespace
}  // namespace hmcdyn::calibrate

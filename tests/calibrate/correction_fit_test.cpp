// SPDX-License-Identifier: BSD-3-Clause
#include "calibrate/correction_fit.hpp"

#include <cmath>
#include <random>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

namespace hmcdyn::calibrate {
namespace {

const cv::Size kImage(640, 480);

struct FakeCamera {
  double scale = 0.0;       ///< z_measured = z (1 + scale + growth(u, v) z)
  double constant = 0.0;    ///< growth(u, v) = constant + slope x, x from -1 to 1 over the columns
  double slope = 0.0;       ///< (1/m)
  double noise = 0.001;     ///< Of a depth (share).
  double outliers = 0.0;    ///< Share of depths that are anywhere.
  double truth_unit = 1.0;  ///< The truth's metre, in metres.

  double error(double z, double u) const {
    return scale + (constant + slope * (2.0 * u / (kImage.width - 1) - 1.0)) * z;
  }
};

std::vector<DepthSample> samplesOf(const FakeCamera& camera, double near, double far) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::normal_distribution<double> normal;
  std::vector<DepthSample> samples;
  for (int track = 0; track < 1500; ++track) {
    DepthSample s;
    s.track = track;
    s.u = unit(random) * (kImage.width - 1);
    s.v = unit(random) * (kImage.height - 1);
    const double z = near + (far - near) * unit(random);
    s.truth = z / camera.truth_unit;
    s.measured = z * (1.0 + camera.error(z, s.u)) * (1.0 + camera.noise * normal(random));
    if (unit(random) < camera.outliers) {
      s.measured = 0.5 + 5.0 * unit(random);
    }
    samples.push_back(s);
  }
  return samples;
}

/// RMS of what is left of the error over the image at 1, 2 and 3 m, as a share of its RMS before.
double shareLeft(const FakeCamera& camera, const CorrectionFit& fit, bool without_mean) {
  std::vector<double> before;
  std::vector<double> after;
  for (const double z : {1.0, 2.0, 3.0}) {
    for (double u = 20.0; u < 640.0; u += 60.0) {
      for (double v = 20.0; v < 480.0; v += 60.0) {
        const double measured = z * (1.0 + camera.error(z, u));
        before.push_back(measured / z - 1.0);
        after.push_back(corrected(fit.correction, measured, u, v, kImage) / z - 1.0);
      }
    }
  }
  const auto rms = [without_mean](const std::vector<double>& values) {
    double mean = 0.0;
    for (const double value : values) {
      mean += without_mean ? value / static_cast<double>(values.size()) : 0.0;
    }
    double sum = 0.0;
    for (const double value : values) {
      sum += (value - mean) * (value - mean);
    }
    return std::sqrt(sum);
  };
  return rms(after) / rms(before);
}

TEST(CorrectionFit, TakesOutScaleAndFieldWhereTheScaleIsKnown) {
  FakeCamera camera;
  camera.scale = 0.012;
  camera.constant = -0.004;
  camera.slope = 0.008;
  camera.noise = 0.003;
  CorrectionFitOptions options;
  options.scale_known = true;
  const CorrectionFit fit = fitCorrection(samplesOf(camera, 0.8, 3.5), kImage, options);
  EXPECT_LT(shareLeft(camera, fit, false), 0.2);
  EXPECT_EQ(fit.truth_scale, 1.0);
  EXPECT_LT(fit.held_out_after, 0.5 * fit.held_out_before);
}

TEST(CorrectionFit, OutliersHaveNoSay) {
  FakeCamera camera;
  camera.slope = 0.01;
  camera.outliers = 0.25;
  CorrectionFitOptions options;
  options.scale_known = true;
  const CorrectionFit fit = fitCorrection(samplesOf(camera, 0.8, 3.5), kImage, options);
  EXPECT_LT(shareLeft(camera, fit, false), 0.2);
}

TEST(CorrectionFit, WithoutAScaleTheFieldIsFoundAndTheMeanDepthKept) {
  // Given a truth in units of 1.05 m, as a trajectory that a wrong depth made would have, the
  // error's changes over image and range are found, and the mean depth is not touched.
  FakeCamera camera;
  camera.scale = 0.02;
  camera.slope = 0.01;
  camera.truth_unit = 1.05;
  const std::vector<DepthSample> samples = samplesOf(camera, 0.8, 3.5);
  const CorrectionFit fit = fitCorrection(samples, kImage);
  EXPECT_LT(shareLeft(camera, fit, true), 0.2);
  std::vector<double> ratios;
  for (const DepthSample& s : samples) {
    ratios.push_back(corrected(fit.correction, s.measured, s.u, s.v, kImage) / s.measured);
  }
  std::nth_element(ratios.begin(), ratios.begin() + 750, ratios.end());
  EXPECT_NEAR(ratios[750], 1.0, 1e-3);
  // A depth of the mean camera is 1.02 z; the truth was z / 1.05.
  EXPECT_NEAR(fit.truth_scale, 1.05 * 1.02, 0.002);
}

TEST(CorrectionFit, APerfectCameraIsLeftAlone) {
  FakeCamera camera;
  camera.noise = 0.005;
  CorrectionFitOptions options;
  options.scale_known = true;
  const CorrectionFit fit = fitCorrection(samplesOf(camera, 0.8, 3.5), kImage, options);
  for (const double u : {50.0, 320.0, 600.0}) {
    EXPECT_NEAR(corrected(fit.correction, 2.0, u, 240.0, kImage), 2.0, 0.004);
  }
  EXPECT_GT(fit.held_out_after, 0.95 * fit.held_out_before) << "there was nothing to gain";
}

TEST(CorrectionFit, EdgesAreNotLookedAt) {
  FakeCamera camera;
  camera.slope = 0.01;
  std::vector<DepthSample> samples = samplesOf(camera, 0.8, 3.5);
  const std::size_t count = samples.size();
  for (std::size_t i = 0; i < count; ++i) {
    DepthSample edge = samples[i];
    edge.at_edge = true;
    edge.measured *= 1.3;
    samples.push_back(edge);
  }
  CorrectionFitOptions options;
  options.scale_known = true;
  EXPECT_LT(shareLeft(camera, fitCorrection(samples, kImage, options), false), 0.2);
}

TEST(CorrectionFit, SaysWhereNothingWasSeen) {
  std::vector<DepthSample> samples = samplesOf({}, 1.0, 2.0);
  for (DepthSample& sample : samples) {
    sample.v *= 0.66;  // four of six rows of squares
  }
  const CorrectionFit fit = fitCorrection(samples, kImage);
  ASSERT_EQ(fit.known_squares.size(), 48U);
  for (std::size_t i = 0; i < 48; ++i) {
    EXPECT_EQ(fit.known_squares[i], i < 32 ? 1 : 0) << i;
  }
  EXPECT_NEAR(fit.known_range[0], 1.0, 0.03);
  EXPECT_NEAR(fit.known_range[1], 2.0, 0.03);
}

TEST(CorrectionFit, TooFewDepthsAreAnErrorThatSaysWhatIsMissing) {
  std::vector<DepthSample> samples = samplesOf({}, 1.0, 2.0);
  samples.resize(99);
  EXPECT_THROW(fitCorrection(samples, kImage), std::runtime_error);
}

TEST(CorrectionFit, DepthsInTheUpperThirdOfTheImageSayNothingOfTheRest) {
  std::vector<DepthSample> samples = samplesOf({}, 1.0, 2.0);
  for (DepthSample& sample : samples) {
    sample.v /= 3.0;  // two of six rows of squares
  }
  try {
    fitCorrection(samples, kImage);
    FAIL() << "a field of which two thirds are a guess";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("16 of 48"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace hmcdyn::calibrate

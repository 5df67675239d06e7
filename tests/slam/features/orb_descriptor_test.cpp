// SPDX-License-Identifier: BSD-3-Clause
#include "slam/features/orb_descriptor.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <gtest/gtest.h>

#include "features/texture.hpp"

namespace hmcdyn::slam {
namespace {

constexpr int kSide = 61;
constexpr int kCentre = 30;

/// Brightness rising along `angle` (rad, clockwise in the image), 2 grey levels a pixel.
cv::Mat ramp(double angle) {
  cv::Mat image(kSide, kSide, CV_8U);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      image.at<uchar>(y, x) = cv::saturate_cast<uchar>(
          128.0 + 2.0 * ((x - kCentre) * std::cos(angle) + (y - kCentre) * std::sin(angle)));
    }
  }
  return image;
}

bool bit(const OrbDescriptor& descriptor, std::size_t i) {
  return ((descriptor[i / 8] >> (i % 8)) & 1) != 0;
}

TEST(CentroidDirection, OfARampIsTheGradient) {
  // On a disc, the first moments of g . p are g times one constant.
  for (int degrees = 0; degrees < 360; degrees += 15) {
    const double angle = degrees * CV_PI / 180.0;
    const cv::Point2f direction = centroidDirection(ramp(angle), kCentre, kCentre);
    EXPECT_NEAR(direction.x, std::cos(angle), 0.004) << degrees;
    EXPECT_NEAR(direction.y, std::sin(angle), 0.004) << degrees;
  }
}

TEST(CentroidDirection, OfABrightHalfPointsIntoIt) {
  cv::Mat image(kSide, kSide, CV_8U, cv::Scalar(10));
  image.rowRange(kCentre + 1, kSide).setTo(200);
  const cv::Point2f direction = centroidDirection(image, kCentre, kCentre);
  EXPECT_FLOAT_EQ(direction.x, 0.0f);
  EXPECT_FLOAT_EQ(direction.y, 1.0f);
}

TEST(CentroidDirection, ReadsNothingOutsideTheDisc) {
  cv::Mat image = ramp(0.7);
  const cv::Point2f expected = centroidDirection(image, kCentre, kCentre);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      if (std::pow(x - kCentre, 2) + std::pow(y - kCentre, 2) > 15.0 * 15.0) {
        image.at<uchar>(y, x) = 255;
      }
    }
  }
  EXPECT_EQ(centroidDirection(image, kCentre, kCentre), expected);
}

TEST(CentroidDirection, OfAFlatPatchIsTheXAxis) {
  const cv::Mat image(kSide, kSide, CV_8U, cv::Scalar(77));
  EXPECT_EQ(centroidDirection(image, kCentre, kCentre), cv::Point2f(1.0f, 0.0f));
}

TEST(OrbPattern, StaysInItsRadiusAndRepeats) {
  const OrbPattern pattern = makeOrbPattern();
  for (std::size_t i = 0; i < 2 * kDescriptorBits; ++i) {
    EXPECT_LE(std::hypot(pattern.x[i], pattern.y[i]), static_cast<float>(kPatternRadius));
  }
  const OrbPattern again = makeOrbPattern();
  EXPECT_EQ(pattern.x, again.x);
  EXPECT_EQ(pattern.y, again.y);
}

TEST(OrbPattern, NoTestIsEmptyOrComesTwice) {
  const OrbPattern p = makeOrbPattern();
  constexpr std::size_t n = kDescriptorBits;
  for (std::size_t i = 0; i < n; ++i) {
    EXPECT_FALSE(p.x[i] == p.x[i + n] && p.y[i] == p.y[i + n]);
    for (std::size_t j = 0; j < i; ++j) {
      const bool same = p.x[i] == p.x[j] && p.y[i] == p.y[j] && p.x[i + n] == p.x[j + n] &&
                        p.y[i + n] == p.y[j + n];
      const bool swapped = p.x[i] == p.x[j + n] && p.y[i] == p.y[j + n] && p.x[i + n] == p.x[j] &&
                           p.y[i + n] == p.y[j];
      EXPECT_FALSE(same || swapped) << i << " and " << j;
    }
  }
}

TEST(Describe, ComparesThePatternsPoints) {
  // On a ramp to the right the point with the smaller x is the darker one.
  const OrbPattern pattern = makeOrbPattern();
  const OrbDescriptor descriptor = describe(ramp(0.0), kCentre, kCentre, {1.0f, 0.0f}, pattern);
  for (std::size_t i = 0; i < kDescriptorBits; ++i) {
    EXPECT_EQ(bit(descriptor, i), pattern.x[i] < pattern.x[i + kDescriptorBits]) << i;
  }
}

TEST(Describe, TurnsThePattern) {
  // A quarter turn takes (x, y) to (-y, x).
  const OrbPattern pattern = makeOrbPattern();
  const OrbDescriptor descriptor = describe(ramp(0.0), kCentre, kCentre, {0.0f, 1.0f}, pattern);
  for (std::size_t i = 0; i < kDescriptorBits; ++i) {
    EXPECT_EQ(bit(descriptor, i), -pattern.y[i] < -pattern.y[i + kDescriptorBits]) << i;
  }
}

TEST(Describe, IsTheSameOnAnImageTurnedByQuarters) {
  const OrbPattern pattern = makeOrbPattern();
  const cv::Mat image = test::texture({kSide, kSide}, 5, 40);
  cv::Mat turned;
  cv::rotate(image, turned, cv::ROTATE_90_CLOCKWISE);
  const cv::Point2f direction = centroidDirection(image, kCentre, kCentre);
  const cv::Point2f turned_direction = centroidDirection(turned, kCentre, kCentre);
  EXPECT_NEAR(turned_direction.x, -direction.y, 1e-6);
  EXPECT_NEAR(turned_direction.y, direction.x, 1e-6);
  EXPECT_EQ(describe(image, kCentre, kCentre, direction, pattern),
            describe(turned, kCentre, kCentre, turned_direction, pattern));
}

TEST(Describe, TellsPointsApartAndForgivesNoise) {
  const OrbPattern pattern = makeOrbPattern();
  const cv::Mat image = test::clouds({640, 480}, 8);
  const cv::Mat noisy = test::withNoise(image, 3.0, 9);
  std::vector<OrbDescriptor> clean;
  double same = 0.0;
  for (int y = 40; y < 440; y += 37) {
    for (int x = 40; x < 600; x += 37) {
      clean.push_back(describe(image, x, y, centroidDirection(image, x, y), pattern));
      const OrbDescriptor other = describe(noisy, x, y, centroidDirection(noisy, x, y), pattern);
      same += hammingDistance(clean.back().data(), other.data());
    }
  }
  same /= static_cast<double>(clean.size());
  double random = 0.0;
  int pairs = 0;
  for (std::size_t i = 0; i + 5 < clean.size(); ++i, ++pairs) {
    random += hammingDistance(clean[i].data(), clean[i + 5].data());
  }
  random /= pairs;
  EXPECT_LT(same, 25.0);
  EXPECT_NEAR(random, 128.0, 13.0) << "unbiased bits differ in half the cases";
}

}  // namespace
}  // namespace hmcdyn::slam

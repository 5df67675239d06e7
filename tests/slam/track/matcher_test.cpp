// SPDX-License-Identifier: BSD-3-Clause
#include "slam/track/matcher.hpp"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "slam/features/frame.hpp"
#include "slam/map/map.hpp"

namespace hmcdyn::slam {
namespace {

/// Key points whose descriptors are these bits and zeros.
Frame frameOf(const std::vector<std::uint32_t>& bits) {
  Features features;
  for (std::size_t i = 0; i < bits.size(); ++i) {
    features.key_points.emplace_back(10.0f + static_cast<float>(i), 10.0f, 31.0f);
    features.key_points.back().octave = 0;
    cv::Mat row = cv::Mat::zeros(1, 32, CV_8U);
    std::memcpy(row.data, &bits[i], sizeof(bits[i]));
    features.descriptors.push_back(row);
  }
  return makeFrame(0, 0.0, features, cv::Mat::ones(40, 40, CV_32F), 1.2f);
}

KeyFrame keyFrameOf(const std::vector<std::uint32_t>& bits) {
  KeyFrame key_frame;
  key_frame.frame = frameOf(bits);
  for (std::size_t j = 0; j < bits.size(); ++j) {
    key_frame.frame.map_point[j] = 100 + static_cast<int>(j);
  }
  return key_frame;
}

TEST(MatchByDescriptor, FindsTheMapPointOfEachKeyPoint) {
  const std::vector<PointMatch> matches =
      matchByDescriptor(frameOf({0x0f, 0xf0}), keyFrameOf({0xf0, 0x0f}), {});
  ASSERT_EQ(matches.size(), 2U);
  EXPECT_EQ(matches[0].map_point, 101);
  EXPECT_EQ(matches[1].map_point, 100);
}

// Map point 100 is 10 bits from key point 0 and 18 from key point 1. Map point 101 is 5 bits from
// key point 0, and 3 from key point 1, which it takes. So the best choice of key point 0 is not
// map point 100, whose best choice it is.
TEST(MatchByDescriptor, AKeyPointWhoseBestChoiceIsAnotherIsLeftAlone) {
  const std::vector<PointMatch> matches =
      matchByDescriptor(frameOf({0x0, 0xff0000}), keyFrameOf({0x3ff, 0x1f0000}), {});
  ASSERT_EQ(matches.size(), 1U);
  EXPECT_EQ(matches[0].map_point, 101);
  EXPECT_EQ(matches[0].key_point, 1U);
  EXPECT_EQ(matches[0].distance, 3);
}

TEST(MatchByDescriptor, OfTwoMapPointsTheMoreSimilarIsTaken) {
  const std::vector<PointMatch> matches =
      matchByDescriptor(frameOf({0x01, 0xfe}), keyFrameOf({0x03, 0x01}), {});
  ASSERT_EQ(matches.size(), 1U);
  EXPECT_EQ(matches[0].map_point, 101);
  EXPECT_EQ(matches[0].key_point, 0U);
  EXPECT_EQ(matches[0].distance, 0);
}

}  // namespace
}  // namespace hmcdyn::slam

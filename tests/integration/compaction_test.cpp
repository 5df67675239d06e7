// SPDX-License-Identifier: BSD-3-Clause
#include "integration/compaction.hpp"

#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "invalid_argument.hpp"

namespace hmcdyn::integration {
namespace {

TEST(Compaction, ArraysThatRunAlongTheKeyPointsShrinkAlike) {
  // Given five key points with what a front end holds of each
  const std::vector<std::uint8_t> keep = {1, 0, 0, 1, 1};
  std::vector<cv::KeyPoint> key_points;
  cv::Mat descriptors(5, 32, CV_8UC1);
  for (int i = 0; i < 5; ++i) {
    key_points.emplace_back(static_cast<float>(i), 10.0f, 7.0f);
    descriptors.row(i).setTo(10 * i);
  }
  const std::vector<std::string> names = {"a", "b", "c", "d", "e"};
  // When
  const std::vector<cv::KeyPoint> kept = keptElements(key_points, keep);
  const cv::Mat kept_descriptors = keptRows(descriptors, keep);
  // Then
  EXPECT_EQ(keptElements(names, keep), (std::vector<std::string>{"a", "d", "e"}));
  ASSERT_EQ(kept.size(), 3U);
  ASSERT_EQ(kept_descriptors.size(), cv::Size(32, 3));
  ASSERT_EQ(kept_descriptors.type(), CV_8UC1);
  const int expected[] = {0, 3, 4};
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(kept[static_cast<std::size_t>(i)].pt.x, static_cast<float>(expected[i]));
    EXPECT_EQ(kept_descriptors.at<std::uint8_t>(i, 0), 10 * expected[i]);
    EXPECT_EQ(kept_descriptors.at<std::uint8_t>(i, 31), 10 * expected[i]);
  }
}

TEST(Compaction, AllNoneAndNothing) {
  const std::vector<int> values = {1, 2};
  EXPECT_EQ(keptElements(values, std::vector<std::uint8_t>{1, 255}), values);
  EXPECT_TRUE(keptElements(values, std::vector<std::uint8_t>{0, 0}).empty());
  EXPECT_TRUE(keptElements(std::vector<int>{}, {}).empty());
  EXPECT_EQ(keptRows(cv::Mat::ones(2, 32, CV_8UC1), std::vector<std::uint8_t>{0, 0}).rows, 0);
  EXPECT_EQ(keptRows(cv::Mat(), {}).rows, 0);
}

TEST(Compaction, RefusesFlagsOfOtherPoints) {
  const std::vector<std::uint8_t> two = {1, 1};
  EXPECT_EQ(test::invalidArgumentOf([&] {
              keptElements(std::vector<int>{1, 2, 3}, two);
            }),
            "compaction: 3 elements, but 2 flags; expected equal sizes");
  EXPECT_NE(test::invalidArgumentOf([&] { keptRows(cv::Mat::ones(3, 2, CV_8UC1), two); }),
            "nothing thrown");
}

}  // namespace
}  // namespace hmcdyn::integration

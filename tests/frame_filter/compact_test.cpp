// SPDX-License-Identifier: BSD-3-Clause
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <hmcdyn/compact.hpp>

#include "invalid_argument.hpp"

namespace hmcdyn {
namespace {

TEST(Compact, AllThatRunsAlongTheKeyPointsShrinksAlikeInPlace) {
  // Given five key points with what a front end holds of each
  const std::vector<std::uint8_t> keep = {1, 0, 0, 1, 255};
  std::vector<cv::KeyPoint> key_points;
  cv::Mat descriptors(5, 32, CV_8UC1);
  for (int i = 0; i < 5; ++i) {
    key_points.emplace_back(static_cast<float>(i), 10.0f, 7.0f);
    descriptors.row(i).setTo(10 * i);
  }
  std::vector<std::string> names = {"a", "b", "c", "d", "e"};
  std::vector<bool> outlier = {true, true, false, false, true};
  // When
  EXPECT_EQ(compact(keep, key_points, descriptors, names, outlier), 3U);
  // Then
  EXPECT_EQ(names, (std::vector<std::string>{"a", "d", "e"}));
  EXPECT_EQ(outlier, (std::vector<bool>{true, false, true}));
  ASSERT_EQ(key_points.size(), 3U);
  ASSERT_EQ(descriptors.size(), cv::Size(32, 3));
  ASSERT_EQ(descriptors.type(), CV_8UC1);
  const int expected[] = {0, 3, 4};
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(key_points[static_cast<std::size_t>(i)].pt.x, static_cast<float>(expected[i]));
    EXPECT_EQ(descriptors.at<std::uint8_t>(i, 0), 10 * expected[i]);
    EXPECT_EQ(descriptors.at<std::uint8_t>(i, 31), 10 * expected[i]);
  }
}

TEST(Compact, WhoeverSharesTheRowsKeepsThem) {
  cv::Mat rows = (cv::Mat_<int>(3, 1) << 1, 2, 3);
  const cv::Mat shared = rows;
  compact(std::vector<std::uint8_t>{0, 0, 1}, rows);
  EXPECT_EQ(rows.at<int>(0), 3);
  EXPECT_EQ(shared.at<int>(0), 1);
}

TEST(Compact, AllNoneAndNothing) {
  std::vector<int> values = {1, 2};
  EXPECT_EQ(compact(std::vector<std::uint8_t>{1, 1}, values), 2U);
  EXPECT_EQ(values, (std::vector<int>{1, 2}));
  cv::Mat rows = cv::Mat::ones(2, 32, CV_8UC1);
  EXPECT_EQ(compact(std::vector<std::uint8_t>{0, 0}, values, rows), 0U);
  EXPECT_TRUE(values.empty());
  EXPECT_EQ(rows.rows, 0);
  EXPECT_EQ(compact(std::vector<std::uint8_t>{}, values, rows), 0U);
}

TEST(Compact, TakesWhatCanOnlyBeMoved) {
  std::vector<std::unique_ptr<int>> values;
  values.push_back(std::make_unique<int>(1));
  values.push_back(std::make_unique<int>(2));
  compact(std::vector<std::uint8_t>{0, 1}, values);
  ASSERT_EQ(values.size(), 1U);
  EXPECT_EQ(*values[0], 2);
}

TEST(Compact, FlagsOfOtherPointsAreRefusedBeforeAnythingChanges) {
  std::vector<int> two = {1, 2};
  std::vector<int> three = {1, 2, 3};
  const std::vector<std::uint8_t> keep = {0, 1};
  EXPECT_EQ(test::invalidArgumentOf([&] { compact(keep, two, three); }),
            "compact: 2 flags, but an array of 3 elements or rows; expected equal sizes");
  EXPECT_EQ(two, (std::vector<int>{1, 2}));
}

}  // namespace
}  // namespace hmcdyn

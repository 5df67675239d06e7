// SPDX-License-Identifier: BSD-3-Clause
#include "slam/output/mask_files.hpp"

#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "slam/input/dataset/temporary_folder.hpp"

namespace hmcdyn::slam {
namespace {

using test::mentions;
using test::messageOf;
using test::TemporaryFolder;

constexpr double kStamp = 1341846434.710184;
constexpr const char* kName = "1341846434.710184.png";

cv::Mat labels() { return (cv::Mat_<std::uint8_t>(2, 4) << 0, 64, 128, 255, 0, 255, 0, 0); }

TEST(MaskFiles, AMaskIsNamedByItsStampAndHoldsTheLabels) {
  const TemporaryFolder folder;
  writeMask(folder.path(), kStamp, labels());
  const cv::Mat read = cv::imread((folder.path() / kName).string(), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(read.type(), CV_8UC1);
  EXPECT_EQ(cv::norm(read, labels(), cv::NORM_INF), 0.0);
  EXPECT_EQ(stampedImage("masks", 1.5), std::filesystem::path("masks/1.500000.png"));
}

TEST(MaskFiles, TheStaticDepthIsInTheInputsUnitsAndLacksWhatMovesOrMayMove) {
  const TemporaryFolder folder;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const cv::Mat depth = (cv::Mat_<float>(2, 4) << 1.0f, 2.0f, 3.0f, 4.0f, 0.0f, 0.0f, nan, 13.2f);
  writeStaticDepth(folder.path(), kStamp, depth, labels(), 5000.0);
  const cv::Mat read = cv::imread((folder.path() / kName).string(), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(read.type(), CV_16UC1);
  // Unknown stays; standing and moving go; 13.2 m are 66000, more than 16 bit hold.
  const cv::Mat expected = (cv::Mat_<std::uint16_t>(2, 4) << 5000, 10000, 0, 0, 0, 0, 0, 0);
  EXPECT_EQ(cv::norm(read, expected, cv::NORM_INF), 0.0) << read;
}

TEST(MaskFiles, EveryDepthOfTheInputComesBackDigitByDigit) {
  const TemporaryFolder folder;
  cv::Mat input(256, 256, CV_16UC1);
  for (int i = 0; i < 65536; ++i) {
    input.at<std::uint16_t>(i / 256, i % 256) = static_cast<std::uint16_t>(i);
  }
  for (const double factor : {5000.0, 1000.0, 4096.0}) {
    cv::Mat metres;
    input.convertTo(metres, CV_32F, 1.0 / factor);
    writeStaticDepth(folder.path(), kStamp, metres, cv::Mat::zeros(256, 256, CV_8UC1), factor);
    const cv::Mat read = cv::imread((folder.path() / kName).string(), cv::IMREAD_UNCHANGED);
    EXPECT_EQ(cv::norm(read, input, cv::NORM_INF), 0.0) << factor;
  }
}

TEST(MaskFiles, WhatCannotBeWrittenIsNamed) {
  const TemporaryFolder folder;
  EXPECT_TRUE(mentions(
      messageOf<std::runtime_error>([&] { writeMask(folder.path() / "none", kStamp, labels()); }),
      {"none", kName, "No such file or directory"}));
  EXPECT_THROW(writeMask(folder.path(), kStamp, cv::Mat()), std::invalid_argument);
  EXPECT_THROW(writeMask(folder.path(), kStamp, cv::Mat(2, 4, CV_16UC1)), std::invalid_argument);
  EXPECT_THROW(writeStaticDepth(folder.path(), kStamp, cv::Mat(3, 4, CV_32FC1), labels(), 5000.0),
               std::invalid_argument);
  EXPECT_THROW(writeStaticDepth(folder.path(), kStamp, cv::Mat(2, 4, CV_32FC1), labels(), 0.0),
               std::invalid_argument);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace hmcdyn::slam

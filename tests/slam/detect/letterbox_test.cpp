// SPDX-License-Identifier: BSD-3-Clause
#include "slam/detect/letterbox.hpp"

#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

namespace hmcdyn::slam {
namespace {

void expectBox(const DetectionBox& box, float x_min, float y_min, float x_max, float y_max,
               float tolerance = 1e-4f) {
  EXPECT_NEAR(box.x_min, x_min, tolerance);
  EXPECT_NEAR(box.y_min, y_min, tolerance);
  EXPECT_NEAR(box.x_max, x_max, tolerance);
  EXPECT_NEAR(box.y_max, y_max, tolerance);
}

TEST(Letterbox, AVgaImageIsOnlyPadded) {
  const Letterbox letterbox = makeLetterbox({640, 480}, 640);
  EXPECT_EQ(letterbox.scaled, cv::Size(640, 480));
  EXPECT_EQ(letterbox.offset, cv::Point(0, 80));
  expectBox(toInput(DetectionBox{10, 20, 30, 40}, letterbox), 10, 100, 30, 120);
  expectBox(toImage({10, 100, 30, 120}, letterbox), 10, 20, 30, 40);
}

TEST(Letterbox, ALargeImageIsShrunkByOneFactor) {
  const Letterbox letterbox = makeLetterbox({1920, 1080}, 640);
  EXPECT_EQ(letterbox.scaled, cv::Size(640, 360));
  EXPECT_EQ(letterbox.offset, cv::Point(0, 140));
  const DetectionBox mapped = toImage({100, 190, 200, 290, 3, 0.5f}, letterbox);
  expectBox(mapped, 300, 150, 600, 450);
  EXPECT_EQ(mapped.class_id, 3);
  EXPECT_EQ(mapped.score, 0.5f);
}

TEST(Letterbox, ATallSmallImageIsEnlarged) {
  const Letterbox letterbox = makeLetterbox({100, 160}, 320);
  EXPECT_EQ(letterbox.scaled, cv::Size(200, 320));
  EXPECT_EQ(letterbox.offset, cv::Point(60, 0));
  expectBox(toInput(DetectionBox{0, 0, 100, 160}, letterbox), 60, 0, 260, 320);
}

TEST(Letterbox, RoundedSidesKeepTheirOwnFactor) {
  // 479 * 640 / 641 = 478.25: 478 rows of the input hold 479 of the image.
  const Letterbox letterbox = makeLetterbox({641, 479}, 640);
  EXPECT_EQ(letterbox.scaled, cv::Size(640, 478));
  EXPECT_EQ(letterbox.offset, cv::Point(0, 81));
  expectBox(toImage({0, 81, 640, 559}, letterbox), 0, 0, 641, 479);
}

TEST(Letterbox, MappingToTheImageInvertsMappingToTheInput) {
  std::mt19937 random(7);
  std::uniform_int_distribution<int> side(1, 2000);
  std::uniform_real_distribution<float> coordinate(-100.0f, 2000.0f);
  for (int i = 0; i < 200; ++i) {
    const Letterbox letterbox = makeLetterbox({side(random), side(random)}, 640);
    const DetectionBox box{coordinate(random), coordinate(random), coordinate(random),
                           coordinate(random)};
    const float pixel = static_cast<float>(std::max(letterbox.image.width, letterbox.image.height));
    expectBox(toImage(toInput(box, letterbox), letterbox), box.x_min, box.y_min, box.x_max,
              box.y_max, 1e-3f * std::max(1.0f, pixel / 640.0f));
  }
}

TEST(Letterbox, TheInputHasTheImageWithinGrey) {
  const Letterbox letterbox = makeLetterbox({20, 10}, 40);  // 40 x 20 at row 10
  const cv::Mat input = toInput(cv::Mat(10, 20, CV_8UC3, cv::Scalar(1, 2, 3)), letterbox);
  ASSERT_EQ(input.size(), cv::Size(40, 40));
  EXPECT_EQ(input.at<cv::Vec3b>(9, 0), cv::Vec3b(114, 114, 114));
  EXPECT_EQ(input.at<cv::Vec3b>(10, 0), cv::Vec3b(1, 2, 3));
  EXPECT_EQ(input.at<cv::Vec3b>(29, 39), cv::Vec3b(1, 2, 3));
  EXPECT_EQ(input.at<cv::Vec3b>(30, 39), cv::Vec3b(114, 114, 114));
}

TEST(Letterbox, AnExtremelyLongImageKeepsARow) {
  EXPECT_EQ(makeLetterbox({100000, 1}, 64).scaled, cv::Size(64, 1));
}

TEST(Letterbox, NothingToFitIsTheCallersMistake) {
  EXPECT_THROW(makeLetterbox({0, 480}, 640), std::invalid_argument);
  EXPECT_THROW(makeLetterbox({640, 480}, 0), std::invalid_argument);
}

}  // namespace
}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#include "slam/detect/yolo_decode.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

#include "input/dataset/temporary_folder.hpp"

namespace hmcdyn::slam {
namespace {

using test::mentions;
using test::messageOf;

cv::Mat zeros(std::initializer_list<int> shape, int type = CV_32F) {
  const std::vector<int> sides(shape);
  return {static_cast<int>(sides.size()), sides.data(), type, cv::Scalar(0)};
}

void setBox(cv::Mat& v5, int row, const std::array<float, 5>& cx_cy_w_h_objectness) {
  std::copy(cx_cy_w_h_objectness.begin(), cx_cy_w_h_objectness.end(), v5.ptr<float>(0, row));
}

void expectBox(const DetectionBox& box, const DetectionBox& expected) {
  EXPECT_FLOAT_EQ(box.x_min, expected.x_min);
  EXPECT_FLOAT_EQ(box.y_min, expected.y_min);
  EXPECT_FLOAT_EQ(box.x_max, expected.x_max);
  EXPECT_FLOAT_EQ(box.y_max, expected.y_max);
  EXPECT_EQ(box.class_id, expected.class_id);
  EXPECT_FLOAT_EQ(box.score, expected.score);
}

TEST(DecodeYoloV5, TheScoreIsObjectnessTimesTheBestClass) {
  cv::Mat output = zeros({1, 3, 85});
  setBox(output, 0, {100.0f, 50.0f, 40.0f, 20.0f, 0.8f});
  output.ptr<float>(0, 0)[5 + 0] = 0.5f;
  output.ptr<float>(0, 0)[5 + 56] = 0.75f;  // chair
  setBox(output, 2, {300.0f, 200.0f, 60.0f, 120.0f, 1.0f});
  output.ptr<float>(0, 2)[5 + 0] = 0.25f;

  const std::vector<DetectionBox> boxes = decodeYoloV5(output, 0.25f);

  ASSERT_EQ(boxes.size(), 2U);
  expectBox(boxes[0], {80.0f, 40.0f, 120.0f, 60.0f, 56, 0.6f});
  expectBox(boxes[1], {270.0f, 140.0f, 330.0f, 260.0f, 0, 0.25f});
}

TEST(DecodeYoloV5, ACandidateBelowTheThresholdIsLeftOut) {
  cv::Mat output = zeros({1, 2, 85});
  setBox(output, 0, {100.0f, 50.0f, 40.0f, 20.0f, 0.9f});  // sure that there is something
  output.ptr<float>(0, 0)[5] = 0.5f;                       // 0.45
  setBox(output, 1, {100.0f, 50.0f, 40.0f, 20.0f, 0.4f});  // sure what, if anything
  output.ptr<float>(0, 1)[5] = 1.0f;                       // 0.40
  EXPECT_EQ(decodeYoloV5(output, 0.44f).size(), 1U);
  EXPECT_EQ(decodeYoloV5(output, 0.46f).size(), 0U);
  EXPECT_EQ(decodeYoloV5(output, 0.39f).size(), 2U);
}

TEST(DecodeYoloV5, CandidatesWithNaNOrWithoutAreaAreLeftOut) {
  cv::Mat output = zeros({1, 5, 85});
  for (int row = 0; row < 5; ++row) {
    setBox(output, row, {100.0f, 50.0f, 40.0f, 20.0f, 1.0f});
    output.ptr<float>(0, row)[5] = 1.0f;
  }
  output.ptr<float>(0, 0)[0] = kNaN;
  output.ptr<float>(0, 1)[2] = 0.0f;
  output.ptr<float>(0, 2)[3] = std::numeric_limits<float>::infinity();
  output.ptr<float>(0, 3)[4] = kNaN;
  EXPECT_EQ(decodeYoloV5(output, 0.25f).size(), 1U);
}

TEST(DecodeYoloV8, CandidatesAreColumnsWithoutObjectness) {
  cv::Mat output = zeros({1, 84, 3});
  const std::array<float, 4> box{100.0f, 50.0f, 40.0f, 20.0f};
  for (int i = 0; i < 4; ++i) {
    output.ptr<float>(0, i)[1] = box[static_cast<std::size_t>(i)];
  }
  output.ptr<float>(0, 4 + 79)[1] = 0.7f;
  output.ptr<float>(0, 4 + 0)[1] = 0.6f;

  const std::vector<DetectionBox> boxes = decodeYoloV8(output, 0.25f);

  ASSERT_EQ(boxes.size(), 1U);
  expectBox(boxes[0], {80.0f, 40.0f, 120.0f, 60.0f, 79, 0.7f});
  EXPECT_TRUE(decodeYoloV8(output, 0.71f).empty());
}

TEST(DecodeDarknet, CoordinatesAreSharesOfTheImage) {
  cv::Mat output = cv::Mat::zeros(2, 85, CV_32F);
  output.at<float>(1, 0) = 0.5f;
  output.at<float>(1, 1) = 0.25f;
  output.at<float>(1, 2) = 0.1f;
  output.at<float>(1, 3) = 0.5f;
  output.at<float>(1, 4) = 0.9f;       // in the class below already
  output.at<float>(1, 5 + 2) = 0.63f;  // car

  const std::vector<DetectionBox> boxes = decodeDarknet(output, {640, 480}, 0.25f);

  ASSERT_EQ(boxes.size(), 1U);
  expectBox(boxes[0], {288.0f, 0.0f, 352.0f, 240.0f, 2, 0.63f});
}

TEST(YoloHead, IsToldByTheShape) {
  EXPECT_EQ(yoloHeadOf(zeros({1, 25200, 85})), YoloHead::kYoloV5);
  EXPECT_EQ(yoloHeadOf(zeros({1, 84, 8400})), YoloHead::kYoloV8);
}

TEST(YoloHead, AnUnknownShapeIsNamed) {
  EXPECT_TRUE(mentions(messageOf<std::invalid_argument>([] {
                         yoloHeadOf(zeros({1, 8400, 84}));
                       }),
                       {"1 x 8400 x 84", "1 x N x 85", "1 x 84 x N"}));
  EXPECT_TRUE(mentions(messageOf<std::invalid_argument>([] {
                         yoloHeadOf(zeros({25200, 85}));
                       }),
                       {"25200 x 85"}));
  EXPECT_TRUE(mentions(messageOf<std::invalid_argument>([] {
                         yoloHeadOf(zeros({1, 3, 80, 80, 85}));
                       }),
                       {"1 x 3 x 80 x 80 x 85"}));
  EXPECT_TRUE(mentions(messageOf<std::invalid_argument>([] {
                         yoloHeadOf(zeros({1, 9, 85}, CV_64F));
                       }),
                       {"CV_64F"}));
}

TEST(YoloHead, TheOtherHeadIsRefused) {
  EXPECT_THROW(decodeYoloV5(zeros({1, 84, 9}), 0.25f), std::invalid_argument);
  EXPECT_THROW(decodeYoloV8(zeros({1, 9, 85}), 0.25f), std::invalid_argument);
  EXPECT_TRUE(mentions(messageOf<std::invalid_argument>([] {
                         decodeDarknet(cv::Mat::zeros(9, 25, CV_32F), {1, 1}, 0.25f);
                       }),
                       {"9 x 25", "N x 85"}));
}

}  // namespace
}  // namespace hmcdyn::slam

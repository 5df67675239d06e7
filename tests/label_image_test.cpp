// SPDX-License-Identifier: BSD-3-Clause
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <hmcdyn/label_image.hpp>

#include "invalid_argument.hpp"

namespace hmcdyn {
namespace {

using testing::ElementsAre;

/// The call is refused, with this text in the message.
template <class Call>
void expectRefusal(Call&& call, const char* text) {
  EXPECT_THAT(test::invalidArgumentOf(call), testing::HasSubstr(text));
}

cv::Mat labelsOfType(int type) {
  const cv::Mat values = (cv::Mat_<int>(2, 3) << 0, 5, 5, 0, 0, 3);
  cv::Mat labels;
  values.convertTo(labels, type);
  return labels;
}

class LabelImage : public testing::TestWithParam<int> {};

INSTANTIATE_TEST_SUITE_P(EachType, LabelImage, testing::Values(CV_8UC1, CV_16UC1, CV_32SC1));

TEST_P(LabelImage, GivesRegionsPointsAndBoxes) {
  // given
  const cv::Mat labels = labelsOfType(GetParam());
  KeyPoints points;
  points.push_back(0.0f, 0.0f, 1.0f);
  points.push_back(2.2f, 0.3f, 1.0f);
  points.push_back(2.0f, 1.0f, 1.0f);
  // when
  const std::vector<LabelRegion> regions = regionsIn(labels);
  const std::vector<int> region = regionsOfPoints(points.view(), labels, regions);
  const std::vector<DetectionBox> boxes = boundingBoxes(labels, regions);
  // then
  ASSERT_EQ(regions.size(), 2U);
  EXPECT_EQ(regions[0].label, 3);
  EXPECT_EQ(regions[1].label, 5);
  EXPECT_THAT(region, ElementsAre(kNoRegion, 1, 0));
  EXPECT_EQ(boxes[1].x_min, 1.0f);
  EXPECT_EQ(boxes[1].x_max, 2.0f);
  EXPECT_EQ(boxes[1].y_max, 0.0f);
}

TEST(LabelImageOfAPart, ReadsThePartOfAnImageOnly) {
  const cv::Mat labels = labelsOfType(CV_8UC1);
  KeyPoints points;
  points.push_back(0.0f, 1.0f, 1.0f);
  const cv::Mat right = labels.colRange(2, 3);
  const std::vector<LabelRegion> regions = {{3, kPersonClassId, 1.0f}};
  EXPECT_THAT(regionsOfPoints(points.view(), right, regions), ElementsAre(0));
}

TEST(LabelImageOfAnotherType, IsRefusedWithItsName) {
  const cv::Mat floats(2, 2, CV_32FC1, cv::Scalar(0));
  const cv::Mat colors(2, 2, CV_8UC3, cv::Scalar::all(0));
  expectRefusal([&] { regionsIn(floats); }, "CV_32FC1");
  expectRefusal([&] { boundingBoxes(colors, {}); }, "CV_8UC3");
  expectRefusal([&] { regionsIn(cv::Mat()); }, "empty");
}

}  // namespace
}  // namespace hmcdyn

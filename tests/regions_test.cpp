// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <hmcdyn/regions.hpp>

#include "invalid_argument.hpp"

namespace hmcdyn {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// The call is refused, with this text in the message.
template <class Call>
void expectRefusal(Call&& call, const char* text) {
  EXPECT_THAT(test::invalidArgumentOf(call), testing::HasSubstr(text));
}

KeyPoints pointsAt(const std::vector<std::array<float, 2>>& pixels) {
  KeyPoints points;
  for (const auto& [u, v] : pixels) {
    points.push_back(u, v, 1.0f);
  }
  return points;
}

std::vector<std::uint32_t> pointsIn(const BoxMembership& membership, std::size_t region) {
  const Span<const std::uint32_t> points = membership.pointsIn(region);
  return {points.begin(), points.end()};
}

// 4 x 3 pixels: a person (7) on the left, a chair (9) at the lower right. The last column of the
// memory is not part of the image.
const std::vector<std::uint8_t> kLabels = {7, 0, 0, 0, 9,  //
                                           7, 7, 0, 9, 9,  //
                                           0, 7, 9, 9, 9};
const LabelImageView<std::uint8_t> kImage{kLabels.data(), 4, 3, 5};
const std::vector<LabelRegion> kRegions = {{9, 56, 0.5f}, {7, kPersonClassId, 0.9f}};

TEST(RegionsOfPoints, TakesTheLabelOfTheNearestPixel) {
  // given points around the border between column 1 (7) and column 2 (0) of row 1
  const KeyPoints points = pointsAt({{1.49f, 1.0f}, {1.5f, 1.0f}, {1.0f, 1.6f}, {3.0f, 0.6f}});
  // when
  const std::vector<int> region = regionsOfPoints(points.view(), kImage, kRegions);
  // then
  EXPECT_THAT(region, ElementsAre(1, kNoRegion, 1, 0));
}

TEST(RegionsOfPoints, GivesNoRegionOutsideTheImageAndToWhatIsNotFinite) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  const KeyPoints points = pointsAt({{-0.6f, 0.0f},
                                     {3.6f, 2.0f},
                                     {0.0f, -0.51f},
                                     {3.0f, 2.5f},
                                     {nan, 1.0f},
                                     {1.0f, nan},
                                     {infinity, 1.0f},
                                     {1e30f, -1e30f},
                                     {-0.4f, 0.4f}});
  const std::vector<int> region = regionsOfPoints(points.view(), kImage, kRegions);
  EXPECT_THAT(region, ElementsAre(kNoRegion, kNoRegion, kNoRegion, kNoRegion, kNoRegion, kNoRegion,
                                  kNoRegion, kNoRegion, 1));
}

TEST(RegionsOfPoints, LeavesLabelsWithoutARegionToTheBackground) {
  const KeyPoints points = pointsAt({{0.0f, 0.0f}, {3.0f, 2.0f}});
  const std::vector<LabelRegion> chair_only = {{9, 56, 1.0f}};
  EXPECT_THAT(regionsOfPoints(points.view(), kImage, chair_only), ElementsAre(kNoRegion, 0));
}

TEST(RegionsOfPoints, ReadsLabelsBeyondAByteAndBelowZero) {
  const std::vector<std::int32_t> labels = {-1, 70000};
  const LabelImageView<std::int32_t> image{labels.data(), 2, 1, 2};
  const KeyPoints points = pointsAt({{0.0f, 0.0f}, {1.0f, 0.0f}});
  const std::vector<LabelRegion> regions = {{70000, 0, 1.0f}, {-1, 0, 1.0f}};
  EXPECT_THAT(regionsOfPoints(points.view(), image, regions), ElementsAre(1, 0));
}

TEST(RegionsOfPoints, RefusesAnImageWithoutPixelsOrWithShortRows) {
  const KeyPoints points = pointsAt({{0.0f, 0.0f}});
  const LabelImageView<std::uint8_t> empty;
  const LabelImageView<std::uint8_t> short_rows{kLabels.data(), 4, 3, 3};
  expectRefusal([&] { regionsOfPoints(points.view(), empty, kRegions); }, "labels");
  expectRefusal([&] { regionsOfPoints(points.view(), short_rows, kRegions); }, "stride");
  expectRefusal([&] { boundingBoxes(empty, kRegions); }, "labels");
}

TEST(AssignToRegions, ListsEachRegionsPointsInTheirOrder) {
  const std::vector<int> region = {2, kNoRegion, 0, 2, 0, 2};
  const BoxMembership membership = assignToRegions(region, 4);
  ASSERT_EQ(membership.boxes(), 4U);
  EXPECT_THAT(pointsIn(membership, 0), ElementsAre(2, 4));
  EXPECT_THAT(pointsIn(membership, 1), IsEmpty());
  EXPECT_THAT(pointsIn(membership, 2), ElementsAre(0, 3, 5));
  EXPECT_THAT(pointsIn(membership, 3), IsEmpty());
}

TEST(AssignToRegions, ForgetsWhatTheReusedMemoryHeld) {
  BoxMembership reuse = assignToRegions(std::vector<int>{0, 0, 1}, 2);
  const BoxMembership membership = assignToRegions(std::vector<int>{kNoRegion}, 1, reuse);
  EXPECT_EQ(membership.boxes(), 1U);
  EXPECT_THAT(membership.indices, IsEmpty());
}

TEST(AssignToRegions, AgreesWithBoxesWhereTheMaskIsTheBox) {
  // given a mask that fills the box of columns 1..2, rows 0..1
  const std::vector<std::uint8_t> labels = {0, 1, 1, 0,  //
                                            0, 1, 1, 0,  //
                                            0, 0, 0, 0};
  const LabelImageView<std::uint8_t> image{labels.data(), 4, 3, 4};
  const std::vector<LabelRegion> regions = {{1, kPersonClassId, 1.0f}};
  KeyPoints points;
  for (int v = 0; v < 3; ++v) {
    for (int u = 0; u < 4; ++u) {
      points.push_back(static_cast<float>(u), static_cast<float>(v), 1.0f);
    }
  }
  // when
  const BoxMembership by_mask =
      assignToRegions(regionsOfPoints(points.view(), image, regions), regions.size());
  const std::vector<DetectionBox> boxes = boundingBoxes(image, regions);
  const BoxMembership by_box = assignToBoxes(points.view(), boxes);
  // then
  EXPECT_EQ(by_mask.offsets, by_box.offsets);
  EXPECT_EQ(by_mask.indices, by_box.indices);
}

TEST(AssignToRegions, RefusesRegionsThatDoNotExist) {
  expectRefusal([] { assignToRegions(std::vector<int>{0, 3}, 3); }, "region[1] is 3");
  expectRefusal([] { assignToRegions(std::vector<int>{-2}, 3); }, "region[0] is -2");
}

TEST(BoundingBoxes, AreTightAndCarryClassAndScore) {
  const std::vector<DetectionBox> boxes = boundingBoxes(kImage, kRegions);
  ASSERT_EQ(boxes.size(), 2U);
  EXPECT_EQ(boxes[0].x_min, 2.0f);
  EXPECT_EQ(boxes[0].y_min, 1.0f);
  EXPECT_EQ(boxes[0].x_max, 3.0f);
  EXPECT_EQ(boxes[0].y_max, 2.0f);
  EXPECT_EQ(boxes[0].class_id, 56);
  EXPECT_EQ(boxes[0].score, 0.5f);
  EXPECT_EQ(boxes[1].x_min, 0.0f);
  EXPECT_EQ(boxes[1].y_min, 0.0f);
  EXPECT_EQ(boxes[1].x_max, 1.0f);
  EXPECT_EQ(boxes[1].y_max, 2.0f);
  EXPECT_EQ(boxes[1].class_id, kPersonClassId);
}

TEST(BoundingBoxes, OfARegionWithoutAPixelHoldNoPoint) {
  const std::vector<LabelRegion> regions = {{200, kPersonClassId, 1.0f}};
  const std::vector<DetectionBox> boxes = boundingBoxes(kImage, regions);
  ASSERT_EQ(boxes.size(), 1U);
  EXPECT_FALSE(boxes[0].contains(0.0f, 0.0f));
  EXPECT_FALSE(boxes[0].contains(-1.0f, -1.0f));
}

}  // namespace
}  // namespace hmcdyn

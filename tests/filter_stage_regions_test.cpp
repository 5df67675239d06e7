// SPDX-License-Identifier: BSD-3-Clause
// The filter stage where a membership, not boxes, says which points belong together.
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <hmcdyn/filter_stage.hpp>
#include <hmcdyn/regions.hpp>

#include "filter_options.hpp"
#include "invalid_argument.hpp"
#include "random_frame.hpp"

namespace hmcdyn {
namespace {

using test::fixedStageOptions;
using test::Frame;
using L = PointLabel;

/// 6 points of a person at 2 m that move by 3 px (region 0), 4 of the wall behind at 4 m that
/// stand, between them in the image.
struct PersonBeforeWall {
  KeyPoints points;
  std::vector<float> distance;
  std::vector<int> region;
  std::vector<DetectionBox> boxes = {{0.0f, 0.0f, 100.0f, 100.0f, kPersonClassId, 1.0f}};

  PersonBeforeWall() {
    for (int i = 0; i < 10; ++i) {
      const bool person = i < 6;
      points.push_back(static_cast<float>(10 * i), 50.0f, person ? 2.0f : 4.0f);
      distance.push_back(person ? 3.0f : 0.1f);
      region.push_back(person ? 0 : kNoRegion);
    }
  }

  FilterStageResult filter(const BoxMembership& membership, FilterRule rule) const {
    FilterStageWorkspace workspace;
    return filterKeyPoints(points.view(), distance, boxes, membership, fixedStageOptions(rule),
                           workspace);
  }
};

TEST(FilterStageRegions, TheWallBesideAPersonKeepsItsFullWeight) {
  // Given a mask of the person, which leaves the wall in the person's box out
  const PersonBeforeWall scene;
  const std::vector<L> expected = {L::kDynamic, L::kDynamic, L::kDynamic, L::kDynamic, L::kDynamic,
                                   L::kDynamic, L::kStatic,  L::kStatic,  L::kStatic,  L::kStatic};
  for (const FilterRule rule : {FilterRule::kHmc, FilterRule::kBox, FilterRule::kEpipolar}) {
    // When
    const FilterStageResult result = scene.filter(assignToRegions(scene.region, 1), rule);
    // Then
    EXPECT_EQ(result.label, expected) << toString(rule);
    EXPECT_EQ(result.weight, (std::vector<float>{0, 0, 0, 0, 0, 0, 1, 1, 1, 1})) << toString(rule);
    EXPECT_EQ(result.boxes.at(0).verdict.points, 6U) << toString(rule);
    EXPECT_EQ(result.frame.points_in_dynamic_boxes, 6U) << toString(rule);
  }
}

TEST(FilterStageRegions, TheBordersOfTheBoxCountForNothing) {
  // Given a box elsewhere, and one without area
  PersonBeforeWall scene;
  const BoxMembership membership = assignToRegions(scene.region, 1);
  const FilterStageResult expected = scene.filter(membership, FilterRule::kHmc);
  for (const DetectionBox& box :
       {DetectionBox{500.0f, 300.0f, 600.0f, 400.0f}, DetectionBox{0.0f, 0.0f, -1.0f, -1.0f}}) {
    scene.boxes = {box};
    const FilterStageResult result = scene.filter(membership, FilterRule::kHmc);
    EXPECT_EQ(result.label, expected.label);
    EXPECT_EQ(result.weight, expected.weight);
  }
}

TEST(FilterStageRegions, ItsClassDecidesTheThreshold) {
  // Given points that move by 0.95 px: beyond a person's 0.9 px, below the others' 1 px
  PersonBeforeWall scene;
  scene.distance.assign(scene.distance.size(), 0.95f);
  const BoxMembership membership = assignToRegions(scene.region, 1);
  EXPECT_TRUE(scene.filter(membership, FilterRule::kHmc).boxes.at(0).verdict.is_dynamic);
  scene.boxes[0].class_id = 56;
  EXPECT_FALSE(scene.filter(membership, FilterRule::kHmc).boxes.at(0).verdict.is_dynamic);
}

TEST(FilterStageRegions, TheMembershipOfBoxesGivesTheResultOfBoxes) {
  test::Random random(20);
  FilterStageWorkspace workspace;  // reused, as from frame to frame
  int dynamic_frames = 0;
  for (int f = 0; f < 60; ++f) {
    // Given
    const Frame frame = test::makeFrame(random);
    const BoxMembership membership = assignToBoxes(frame.points.view(), frame.boxes);
    for (const FilterRule rule : kFilterRules) {
      const FilterStageOptions options = fixedStageOptions(rule);
      // When
      const FilterStageResult& by_membership = filterKeyPoints(
          frame.points.view(), frame.distance, frame.boxes, membership, options, workspace);
      const FilterStageResult by_box = frame.filter(options);
      // Then
      EXPECT_EQ(by_membership.label, by_box.label);
      EXPECT_EQ(by_membership.weight, by_box.weight);
      EXPECT_EQ(by_membership.cluster, by_box.cluster);
      dynamic_frames += by_box.frame.dynamic > 0 ? 1 : 0;
    }
  }
  EXPECT_GT(dynamic_frames, 100);  // of 420: the comparison had something to compare
}

TEST(FilterStageRegions, AMembershipThatDoesNotFitIsRefused) {
  const PersonBeforeWall scene;
  const auto refusal = [&](const BoxMembership& membership) {
    return test::invalidArgumentOf([&] { scene.filter(membership, FilterRule::kHmc); });
  };
  EXPECT_EQ(refusal(assignToRegions(scene.region, 2)),
            "testBoxes: membership of 2 boxes for 1 boxes");
  EXPECT_THAT(refusal({{0, 1}, {10}}), testing::HasSubstr("membership holds point 10"));
  const char* const offsets = "membership has offsets that do not rise from 0";
  EXPECT_THAT(refusal({{1, 2}, {0, 1}}), testing::HasSubstr(offsets));
  EXPECT_THAT(refusal({{0, 3}, {0, 1}}), testing::HasSubstr(offsets));
  PersonBeforeWall two_boxes;
  two_boxes.boxes.push_back(two_boxes.boxes[0]);
  const BoxMembership falling = {{0, 2, 1}, {0}};
  EXPECT_THAT(test::invalidArgumentOf([&] { two_boxes.filter(falling, FilterRule::kHmc); }),
              testing::HasSubstr(offsets));
}

}  // namespace
}  // namespace hmcdyn

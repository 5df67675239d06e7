// SPDX-License-Identifier: BSD-3-Clause
// filterDynamicFeatures with masks in place of boxes.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <hmcdyn/dynamic_feature_filter.hpp>
#include <hmcdyn/label_image.hpp>

#include "filter_options.hpp"
#include "invalid_argument.hpp"
#include "layered_scene.hpp"

namespace hmcdyn {
namespace {

using test::LayeredScene;

constexpr int kLabel = 7;
const std::vector<LabelRegion> kThing = {{kLabel, kPersonClassId, 1.0f}};

DynamicFeatureFilterOptions maskOptions(bool use_belief) {
  DynamicFeatureFilterOptions options;
  options.flow.window = 11;
  options.flow.max_level = 1;
  options.flow.max_iterations = 30;
  options.flow.max_difference = 12.0f;
  options.flow_margin = 20.0f;
  options.flow_in_boxes = 100;
  options.flow_background = 120;
  options.two_view.min_background_matches = 60;
  options.two_view.min_background_cells = 5;
  options.use_belief = use_belief;
  options.stage = test::fixedStageOptions(FilterRule::kHmc);
  options.max_median_distance = 0.5f;
  return options;
}

cv::Rect pixelsOf(const DetectionBox& box) {
  return {cv::Point(static_cast<int>(box.x_min), static_cast<int>(box.y_min)),
          cv::Point(static_cast<int>(box.x_max) + 1, static_cast<int>(box.y_max) + 1)};
}

cv::Mat emptyMask() {
  return cv::Mat::zeros(LayeredScene::kHeight, LayeredScene::kWidth, CV_16UC1);
}

/// A frame of the scene, compared with the one before.
struct MaskedClip {
  explicit MaskedClip(bool use_belief) : options(maskOptions(use_belief)) {
    current = buildFlowPyramid(scene.grayOf(0), options.flow);
    before = buildFlowPyramid(scene.grayOf(1), options.flow);
    earlier.emplace_back();
    earlier.back().pyramid = &before;
    earlier.back().age = 1.0 / 30.0;
    input.pyramid = &current;
    input.points = points.view();
    input.earlier = earlier;
    input.depth = {depth.ptr<float>(), depth.cols, depth.rows, depth.step1()};
  }
  ~MaskedClip() = default;
  MaskedClip(const MaskedClip&) = delete;  // `input` views the other members
  MaskedClip& operator=(const MaskedClip&) = delete;
  MaskedClip(MaskedClip&&) = delete;
  MaskedClip& operator=(MaskedClip&&) = delete;

  DynamicFeatureFilterResult byBoxes(const std::vector<DetectionBox>& boxes) const {
    DynamicFeatureFilterInput frame = input;
    frame.regions = boxes;
    DynamicFeatureFilterWorkspace workspace;
    return filterDynamicFeatures(frame, options, workspace);
  }
  DynamicFeatureFilterResult byMask(const cv::Mat& labels,
                                    const std::vector<LabelRegion>& regions = kThing) const {
    DynamicFeatureFilterInput frame = input;
    frame.regions = Regions(labels, regions);
    DynamicFeatureFilterWorkspace workspace;
    return filterDynamicFeatures(frame, options, workspace);
  }

  DynamicFeatureFilterOptions options;
  LayeredScene scene{LayeredScene::kUsualStep, {1.0, -3.0}};
  KeyPoints points = LayeredScene::keyPoints();
  cv::Mat depth = scene.depthOf(0);
  FlowPyramid current;
  FlowPyramid before;
  std::vector<EarlierFrame> earlier;
  DynamicFeatureFilterInput input;
};

std::vector<float> withoutNaN(std::vector<float> values) {
  std::replace_if(
      values.begin(), values.end(), [](float value) { return std::isnan(value); }, -1.0f);
  return values;
}

void expectEqual(const DynamicFeatureFilterResult& result,
                 const DynamicFeatureFilterResult& expected) {
  EXPECT_EQ(withoutNaN(result.distance), withoutNaN(expected.distance));
  EXPECT_EQ(result.stage.label, expected.stage.label);
  EXPECT_EQ(result.stage.weight, expected.stage.weight);
  EXPECT_EQ(result.stage.cluster, expected.stage.cluster);
  EXPECT_EQ(withoutNaN(result.belief.belief), withoutNaN(expected.belief.belief));
  EXPECT_EQ(result.belief.weight, expected.belief.weight);
  EXPECT_EQ(result.stage.frame.dynamic_boxes, expected.stage.frame.dynamic_boxes);
  EXPECT_EQ(result.stage.frame.points_in_dynamic_boxes,
            expected.stage.frame.points_in_dynamic_boxes);
}

TEST(DynamicFeatureFilterMask, AMaskThatFillsItsBoxesGivesTheResultOfTheBoxes) {
  for (const bool use_belief : {false, true}) {
    SCOPED_TRACE(use_belief ? "with beliefs" : "without");
    // Given two boxes of two classes, and a mask of the same pixels
    const MaskedClip clip(use_belief);
    const std::vector<DetectionBox> boxes = {LayeredScene::boxOfThing(),
                                             {20.0f, 90.0f, 80.0f, 200.0f, 56, 0.5f}};
    cv::Mat labels = emptyMask();
    labels(pixelsOf(boxes[0])).setTo(300);
    labels(pixelsOf(boxes[1])).setTo(2);
    // When
    const DynamicFeatureFilterResult expected = clip.byBoxes(boxes);
    const DynamicFeatureFilterResult result =
        clip.byMask(labels, {{300, kPersonClassId, 1.0f}, {2, 56, 0.5f}});
    // Then
    expectEqual(result, expected);
    EXPECT_GT(expected.stage.frame.dynamic, 50U);
    EXPECT_EQ(result.stage.boxes.size(), 2U);
  }
}

TEST(DynamicFeatureFilterMask, AnLShapeLeavesThePointsInItsBoxAlone) {
  for (const bool use_belief : {false, true}) {
    SCOPED_TRACE(use_belief ? "with beliefs" : "without");
    // Given an L on the moving thing: its left third, and its lower third
    const MaskedClip clip(use_belief);
    cv::Mat labels = emptyMask();
    labels(cv::Rect(cv::Point(110, 50), cv::Point(137, 191))).setTo(kLabel);
    labels(cv::Rect(cv::Point(110, 145), cv::Point(191, 191))).setTo(kLabel);
    const DetectionBox box = boundingBoxes(labels, kThing).at(0);
    ASSERT_EQ(box.x_max, 190.0f);
    // When
    const DynamicFeatureFilterResult result = clip.byMask(labels);
    // Then what lies in the box but not on the L is static, though it moves
    int beside = 0;
    int on_l = 0;
    for (std::size_t i = 0; i < clip.points.size(); ++i) {
      const float u = clip.points.u[i];
      const float v = clip.points.v[i];
      if (labels.at<std::uint16_t>(static_cast<int>(v), static_cast<int>(u)) == kLabel) {
        ++on_l;
        EXPECT_EQ(result.stage.label[i], PointLabel::kDynamic) << u << ", " << v;
      } else if (box.contains(u, v)) {
        ++beside;
        EXPECT_EQ(result.stage.label[i], PointLabel::kStatic) << u << ", " << v;
        EXPECT_EQ(result.stage.weight[i], 1.0f) << u << ", " << v;
        EXPECT_EQ(result.stage.cluster[i], kNoise) << u << ", " << v;
      }
    }
    EXPECT_GT(beside, 20);
    EXPECT_GT(on_l, 20);
    EXPECT_EQ(result.stage.boxes.at(0).verdict.is_dynamic, true);
  }
}

TEST(DynamicFeatureFilterMask, WithoutARegionNothingIsFollowedAndAllIsStatic) {
  const MaskedClip clip(true);
  cv::Mat labels = emptyMask();
  labels(pixelsOf(LayeredScene::boxOfThing())).setTo(kLabel);
  const DynamicFeatureFilterResult result = clip.byMask(labels, {});
  EXPECT_TRUE(result.earlier.empty());
  EXPECT_EQ(result.stage.label, std::vector<PointLabel>(clip.points.size(), PointLabel::kStatic));
}

TEST(DynamicFeatureFilterMask, TwoImagesAndAMaskAreTheSameCall) {
  // Given
  const MaskedClip clip(false);
  cv::Mat labels = emptyMask();
  labels(pixelsOf(LayeredScene::boxOfThing())).setTo(kLabel);
  // When
  const DynamicFeatureFilterResult result = filterDynamicFeatures(
      clip.scene.grayOf(1), clip.scene.grayOf(0), clip.points.view(), labels, kThing, clip.options);
  // Then
  expectEqual(result, clip.byMask(labels));
  EXPECT_GT(result.stage.frame.dynamic, 50U);
}

TEST(DynamicFeatureFilterMask, RefusesWhatIsNoMaskOfTheFrame) {
  const MaskedClip clip(false);
  const auto refusal = [&](const cv::Mat& labels) {
    return test::invalidArgumentOf([&] { clip.byMask(labels); });
  };
  EXPECT_THAT(refusal(cv::Mat::zeros(10, 20, CV_8UC1)),
              testing::HasSubstr("labels is 20 x 10 px; expected the image's 320 x 240"));
  EXPECT_THAT(refusal(cv::Mat::zeros(LayeredScene::kHeight, LayeredScene::kWidth, CV_32FC1)),
              testing::HasSubstr("CV_8UC1, CV_16UC1 or CV_32SC1"));
  EXPECT_THAT(refusal(cv::Mat()), testing::HasSubstr("1 regions, but labels is empty"));
}

TEST(DynamicFeatureFilterMask, RefusesBoxesAndAMaskAtOnce) {
  const MaskedClip clip(false);
  DynamicFeatureFilterInput frame = clip.input;
  const std::vector<DetectionBox> boxes = {LayeredScene::boxOfThing()};
  frame.regions = boxes;
  frame.regions.labels = emptyMask();
  DynamicFeatureFilterWorkspace workspace;
  EXPECT_THAT(
      test::invalidArgumentOf([&] { filterDynamicFeatures(frame, clip.options, workspace); }),
      testing::HasSubstr("1 boxes and a label image; expected one or the other"));
}

TEST(DynamicFeatureFilterMask, TwoImagesWithoutAMaskAreRefused) {
  const MaskedClip clip(false);
  EXPECT_THAT(test::invalidArgumentOf([&] {
                filterDynamicFeatures(clip.scene.grayOf(1), clip.scene.grayOf(0),
                                      clip.points.view(), cv::Mat(), kThing, clip.options);
              }),
              testing::HasSubstr("labels is empty"));
}

}  // namespace
}  // namespace hmcdyn

// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <hmcdyn/dynamic_feature_filter.hpp>

#include "filter_options.hpp"
#include "invalid_argument.hpp"
#include "layered_scene.hpp"

namespace hmcdyn {
namespace {

using test::LayeredScene;

/// Every option set, so that tests of rules do not depend on tuned defaults.
DynamicFeatureFilterOptions fixedOptions() {
  DynamicFeatureFilterOptions options;
  options.flow_background = 0;
  options.flow.window = 15;
  options.flow.max_level = 1;
  options.flow.max_iterations = 30;
  options.flow.forward_backward = true;
  options.flow.epsilon = 0.01f;
  options.flow.max_forward_backward_error = 0.5f;
  options.two_view.min_matches = 12;
  options.two_view.min_background_matches = 60;
  options.two_view.min_background_cells = 5;
  options.two_view.inlier_threshold = 0.5f;
  options.two_view.confidence = 0.999;
  options.two_view.max_iterations = 2000;
  options.two_view.seed = 1;
  options.two_view.still_share = 0.9f;
  options.two_view.still_displacement = 0.35f;
  options.two_view.min_conditioning = 2.0f;
  options.two_view.min_homography_share = 0.6f;
  options.distance = DistanceKind::kTwoView;
  options.ego_motion.baseline_fx = 0.0f;
  options.stage = test::fixedStageOptions(FilterRule::kHmc);
  options.max_median_distance = 0.5f;
  return options;
}

/// The current frame of a scene, and earlier ones by how many frames ago they were.
struct Clip {
  Clip(const LayeredScene& of, const std::vector<int>& frames_ago,
       const DynamicFeatureFilterOptions& with = fixedOptions())
      : options(with), points(LayeredScene::keyPoints()), boxes{LayeredScene::boxOfThing()} {
    current = buildFlowPyramid(of.grayOf(0), options.flow);
    for (const int frames : frames_ago) {
      pyramids.push_back(buildFlowPyramid(of.grayOf(frames), options.flow));
      depths.push_back(of.depthOf(frames));
      motions.push_back(of.motionSince(frames));
    }
  }

  std::vector<EarlierFrame> earlierFrames() const {
    std::vector<EarlierFrame> frames;
    for (std::size_t i = 0; i < pyramids.size(); ++i) {
      frames.push_back({&pyramids[i], depths[i], motions[i]});
    }
    return frames;
  }
  DynamicFeatureFilterResult run(const std::vector<EarlierFrame>& earlier) const {
    DynamicFeatureFilterWorkspace workspace;
    return filterDynamicFeatures({&current, points.view(), boxes, earlier, LayeredScene::kCamera},
                                 options, workspace);
  }
  DynamicFeatureFilterResult run() const { return run(earlierFrames()); }

  DynamicFeatureFilterOptions options;
  KeyPoints points;
  std::vector<DetectionBox> boxes;
  FlowPyramid current;
  std::vector<FlowPyramid> pyramids;
  std::vector<cv::Mat> depths;
  std::vector<Eigen::Isometry3d> motions;
};

bool onThing(const KeyPoints& points, std::size_t i) {
  return LayeredScene::isThing(points.u[i], points.v[i]);
}

/// Quantile of the distances of the thing's points, or of the walls'.
double quantile(const Clip& clip, const std::vector<float>& distance, bool of_thing, double share) {
  std::vector<float> values;
  for (std::size_t i = 0; i < distance.size(); ++i) {
    if (onThing(clip.points, i) == of_thing && !std::isnan(distance[i])) {
      values.push_back(distance[i]);
    }
  }
  std::sort(values.begin(), values.end());
  return values.at(static_cast<std::size_t>(share * static_cast<double>(values.size() - 1)));
}

void expectEqual(const std::vector<float>& actual, const std::vector<float>& expected) {
  ASSERT_EQ(actual.size(), expected.size());
  for (std::size_t i = 0; i < actual.size(); ++i) {
    EXPECT_TRUE(actual[i] == expected[i] || (std::isnan(actual[i]) && std::isnan(expected[i])))
        << "point " << i << ": " << actual[i] << " and " << expected[i];
  }
}

TEST(DynamicFeatureFilter, AMovingThingGoesAndTheWallBesideItStays) {
  // Given a thing that rises by 3 px
  const Clip clip(LayeredScene(LayeredScene::kUsualStep, {1.0, -3.0}), {1});

  // When
  const DynamicFeatureFilterResult result = clip.run();

  // Then the camera's motion is found from the walls
  ASSERT_EQ(result.earlier.size(), 1U);
  EXPECT_TRUE(result.earlier[0].used);
  EXPECT_EQ(result.earlier[0].motion.source, MatchSource::kBackground);
  EXPECT_EQ(result.earlier[0].motion.verdict, FundamentalVerdict::kDefined);
  EXPECT_LT(result.earlier[0].motion.median_distance, 0.1f);

  // ... the thing is 3 px off the epipolar lines, which are rows, the walls are on them
  EXPECT_NEAR(quantile(clip, result.distance, true, 0.1), 3.0, 0.2);
  EXPECT_NEAR(quantile(clip, result.distance, true, 0.9), 3.0, 0.2);
  EXPECT_LT(quantile(clip, result.distance, false, 0.95), 0.3);

  // ... and every point gets its label.
  std::size_t suspects = 0;
  for (std::size_t i = 0; i < clip.points.size(); ++i) {
    const bool in_box = clip.boxes[0].contains(clip.points.u[i], clip.points.v[i]);
    const PointLabel expected = onThing(clip.points, i) ? PointLabel::kDynamic
                                : in_box                ? PointLabel::kSuspect
                                                        : PointLabel::kStatic;
    EXPECT_EQ(result.stage.label[i], expected)
        << clip.points.u[i] << ", " << clip.points.v[i] << ": " << result.distance[i];
    suspects += expected == PointLabel::kSuspect ? 1 : 0;
  }
  EXPECT_GT(suspects, 20U);
}

TEST(DynamicFeatureFilter, TheEgoMotionDistanceSeesMotionAlongTheEpipolarLine) {
  // Given a thing that moves along its row by 1 px where 4 px would be rest
  DynamicFeatureFilterOptions options = fixedOptions();
  const LayeredScene scene(LayeredScene::kUsualStep, {1.0, 0.0});
  const Clip two_view(scene, {1}, options);
  EXPECT_LT(quantile(two_view, two_view.run().distance, true, 0.9), 0.3);

  options.distance = DistanceKind::kEgoMotion;
  const Clip ego(scene, {1}, options);
  const DynamicFeatureFilterResult result = ego.run();
  EXPECT_NEAR(quantile(ego, result.distance, true, 0.1), 3.0, 0.2);
  EXPECT_NEAR(quantile(ego, result.distance, true, 0.9), 3.0, 0.2);
  EXPECT_LT(quantile(ego, result.distance, false, 0.95), 0.3);
  EXPECT_TRUE(result.earlier[0].used);
}

TEST(DynamicFeatureFilter, TheLargerDistanceIsPointByPoint) {
  // Given a thing that moves across by 2 px and along by 1 instead of 4: 2 px, and hypot(3, 2).
  const LayeredScene scene(LayeredScene::kUsualStep, {1.0, -2.0});
  DynamicFeatureFilterOptions options = fixedOptions();
  const std::vector<float> two_view = Clip(scene, {1}, options).run().distance;
  options.distance = DistanceKind::kEgoMotion;
  const std::vector<float> ego = Clip(scene, {1}, options).run().distance;
  options.distance = DistanceKind::kLarger;
  const Clip both(scene, {1}, options);
  const std::vector<float> larger = both.run().distance;

  EXPECT_NEAR(quantile(both, two_view, true, 0.5), 2.0, 0.1);
  EXPECT_NEAR(quantile(both, larger, true, 0.5), std::hypot(3.0, 2.0), 0.1);
  std::vector<float> expected = ego;
  for (std::size_t i = 0; i < ego.size(); ++i) {
    expected[i] = std::fmax(ego[i], two_view[i]);
  }
  expectEqual(larger, expected);
}

TEST(DynamicFeatureFilter, TheLargestDistanceOverTheEarlierFramesCounts) {
  // Given a slow thing: 0.6 px a frame, which only the frame five back shows
  const LayeredScene scene(0.5 * LayeredScene::kUsualStep, {0.4, -0.6});
  const Clip near(scene, {1});
  const Clip both(scene, {1, 5});
  const DynamicFeatureFilterResult of_near = near.run();
  const DynamicFeatureFilterResult of_far = Clip(scene, {5}).run();
  const DynamicFeatureFilterResult result = both.run();
  EXPECT_LT(quantile(near, of_near.distance, true, 0.9), 0.9);
  EXPECT_NEAR(quantile(both, result.distance, true, 0.5), 3.0, 0.1);
  EXPECT_EQ(of_near.stage.frame.dynamic_boxes, 0U);
  EXPECT_EQ(result.stage.frame.dynamic_boxes, 1U);
  ASSERT_EQ(result.earlier.size(), 2U);
  EXPECT_TRUE(result.earlier[0].used);
  EXPECT_TRUE(result.earlier[1].used);

  std::vector<float> expected = of_near.distance;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    expected[i] = std::fmax(of_near.distance[i], of_far.distance[i]);
  }
  expectEqual(result.distance, expected);
}

TEST(DynamicFeatureFilter, FramesWhoseModelDoesNotHoldDoNotCount) {
  // Given an earlier frame of another scene, and one without texture, beside a good one
  const LayeredScene scene(LayeredScene::kUsualStep, {1.0, -3.0});
  Clip clip(scene, {1});
  const std::vector<float> good = clip.run().distance;
  const test::Texture other(99);
  clip.pyramids.push_back(
      buildFlowPyramid(test::drawImage(LayeredScene::kWidth, LayeredScene::kHeight,
                                       [&](double x, double y) { return other(x, y); }),
                       clip.options.flow));
  clip.pyramids.push_back(
      buildFlowPyramid(cv::Mat(LayeredScene::kHeight, LayeredScene::kWidth, CV_8UC1, cv::Scalar(9)),
                       clip.options.flow));
  const std::vector<EarlierFrame> frames{
      {&clip.pyramids[1], {}, {}}, {&clip.pyramids[0], {}, {}}, {&clip.pyramids[2], {}, {}}};

  // When
  const DynamicFeatureFilterResult result = clip.run(frames);

  // Then
  ASSERT_EQ(result.earlier.size(), 3U);
  EXPECT_FALSE(result.earlier[0].used) << result.earlier[0].motion.median_distance;
  EXPECT_TRUE(result.earlier[1].used);
  EXPECT_FALSE(result.earlier[2].used);
  EXPECT_EQ(result.earlier[2].flow.found, 0U);
  EXPECT_EQ(result.earlier[2].motion.verdict, FundamentalVerdict::kTooFewMatches);
  expectEqual(result.distance, good);
}

TEST(DynamicFeatureFilter, WithoutAnEarlierFrameEverythingIsStatic) {
  const Clip clip(LayeredScene(LayeredScene::kUsualStep, {1.0, -3.0}), {});
  for (const DistanceKind kind :
       {DistanceKind::kTwoView, DistanceKind::kEgoMotion, DistanceKind::kLarger}) {
    Clip with = clip;
    with.options.distance = kind;
    const DynamicFeatureFilterResult result = with.run();
    EXPECT_TRUE(result.earlier.empty());
    EXPECT_EQ(result.stage.frame.measured, 0U);
    EXPECT_EQ(result.stage.label, std::vector<PointLabel>(clip.points.size(), PointLabel::kStatic));
    EXPECT_EQ(result.stage.weight, std::vector<float>(clip.points.size(), 1.0f));
    for (const float distance : result.distance) {
      EXPECT_TRUE(std::isnan(distance));
    }
  }
}

TEST(DynamicFeatureFilter, IdenticalImagesAreACameraThatStandsStill) {
  const cv::Mat image = LayeredScene(LayeredScene::kUsualStep, {1.0, -3.0}).grayOf(0);
  const KeyPoints points = LayeredScene::keyPoints();
  const std::vector<DetectionBox> boxes{LayeredScene::boxOfThing()};
  const DynamicFeatureFilterResult result =
      filterDynamicFeatures(image, image.clone(), points.view(), boxes, fixedOptions());
  ASSERT_EQ(result.earlier.size(), 1U);
  EXPECT_EQ(result.earlier[0].motion.verdict, FundamentalVerdict::kCameraStill);
  EXPECT_TRUE(result.earlier[0].used);
  EXPECT_EQ(result.earlier[0].flow.found, points.size());
  for (const float distance : result.distance) {
    EXPECT_NEAR(distance, 0.0, 0.02);
  }
  EXPECT_EQ(result.stage.label, std::vector<PointLabel>(points.size(), PointLabel::kStatic));
}

TEST(DynamicFeatureFilter, AThingThatMovesBeforeAStillCamera) {
  // Given no motion of the camera, where F is not defined: hypot(1, 3) px under plain displacement.
  const Clip clip(LayeredScene(0.0, {1.0, -3.0}), {1});
  const DynamicFeatureFilterResult result = clip.run();
  EXPECT_EQ(result.earlier[0].motion.verdict, FundamentalVerdict::kCameraStill);
  EXPECT_NEAR(quantile(clip, result.distance, true, 0.5), std::hypot(1.0, 3.0), 0.1);
  for (std::size_t i = 0; i < clip.points.size(); ++i) {
    EXPECT_EQ(result.stage.label[i] == PointLabel::kDynamic, onThing(clip.points, i));
  }
}

TEST(DynamicFeatureFilter, TwoImagesAreTheSmallestCall) {
  const LayeredScene scene(LayeredScene::kUsualStep, {1.0, -3.0});
  const Clip clip(scene, {1});
  const DynamicFeatureFilterResult full = clip.run();
  const DynamicFeatureFilterResult small = filterDynamicFeatures(
      scene.grayOf(1), scene.grayOf(0), clip.points.view(), clip.boxes, clip.options);
  expectEqual(small.distance, full.distance);
  EXPECT_EQ(small.stage.label, full.stage.label);
  EXPECT_EQ(small.stage.weight, full.stage.weight);
}

TEST(DynamicFeatureFilter, AReusedWorkspaceGivesWhatAFreshOneGives) {
  const Clip moving(LayeredScene(LayeredScene::kUsualStep, {1.0, -3.0}), {1});
  Clip fewer = moving;
  fewer.points.u.resize(40);
  fewer.points.v.resize(40);
  fewer.points.depth.resize(40);
  fewer.boxes.clear();
  DynamicFeatureFilterWorkspace workspace;
  for (const Clip* clip : std::vector<const Clip*>{&moving, &fewer, &moving}) {
    const std::vector<EarlierFrame> earlier = clip->earlierFrames();
    const DynamicFeatureFilterResult reused = filterDynamicFeatures(
        {&clip->current, clip->points.view(), clip->boxes, earlier, LayeredScene::kCamera},
        clip->options, workspace);
    const DynamicFeatureFilterResult fresh = clip->run();
    expectEqual(reused.distance, fresh.distance);
    EXPECT_EQ(reused.stage.label, fresh.stage.label);
    EXPECT_EQ(reused.stage.weight, fresh.stage.weight);
    EXPECT_EQ(reused.stage.cluster, fresh.stage.cluster);
  }
}

TEST(DynamicFeatureFilter, NoKeyPointsAreFine) {
  Clip clip(LayeredScene(LayeredScene::kUsualStep, {1.0, -3.0}), {1});
  clip.points = {};
  const DynamicFeatureFilterResult result = clip.run();
  EXPECT_TRUE(result.distance.empty());
  EXPECT_FALSE(result.earlier.at(0).used);
}

TEST(DynamicFeatureFilter, MissingInputIsNamed) {
  DynamicFeatureFilterOptions options = fixedOptions();
  options.distance = DistanceKind::kEgoMotion;
  const Clip clip(LayeredScene(LayeredScene::kUsualStep, {1.0, -3.0}), {1}, options);
  const auto message = [&](auto change, const PinholeCamera& camera = LayeredScene::kCamera) {
    std::vector<EarlierFrame> earlier = clip.earlierFrames();
    DynamicFeatureFilterInput input{&clip.current, clip.points.view(), clip.boxes, earlier, camera};
    change(input, earlier[0]);
    DynamicFeatureFilterWorkspace workspace;
    return test::invalidArgumentOf([&] { filterDynamicFeatures(input, options, workspace); });
  };
  using Input = DynamicFeatureFilterInput;
  using Frame = EarlierFrame;
  EXPECT_EQ(message([](Input&, Frame&) {}), "nothing thrown");
  EXPECT_EQ(message([](Input& input, Frame&) { input.pyramid = nullptr; }),
            "filterDynamicFeatures: pyramid of the current frame is null");
  EXPECT_EQ(message([](Input&, Frame& frame) { frame.pyramid = nullptr; }),
            "filterDynamicFeatures: pyramid of an earlier frame is null");
  const std::string needs =
      "filterDynamicFeatures: the ego-motion distance needs current_from_earlier and depth "
      "(CV_32FC1, m, of the image's size) of every earlier frame";
  EXPECT_EQ(message([](Input&, Frame& frame) { frame.current_from_earlier.reset(); }), needs);
  EXPECT_EQ(message([](Input&, Frame& frame) { frame.depth = cv::Mat(); }), needs);
  EXPECT_EQ(message([](Input&, Frame& frame) {
              frame.depth = cv::Mat(frame.depth.size(), CV_16UC1, cv::Scalar(0));
            }),
            needs);
  EXPECT_EQ(message([](Input&, Frame& frame) { frame.depth = frame.depth.rowRange(0, 100); }),
            needs);
  EXPECT_EQ(message([](Input&, Frame&) {}, PinholeCamera{}),
            "filterDynamicFeatures: the ego-motion distance needs a camera with fx, fy > 0");
  KeyPoints unequal = clip.points;
  unequal.v.pop_back();
  EXPECT_NE(message([&](Input& input, Frame&) { input.points = unequal.view(); }),
            "nothing thrown");
}

TEST(DynamicFeatureFilter, OtherImagesAreRefused) {
  const cv::Mat gray(60, 80, CV_8UC1, cv::Scalar(1));
  const cv::Mat color(60, 80, CV_8UC3, cv::Scalar::all(1));
  const cv::Mat large(61, 80, CV_8UC1, cv::Scalar(1));
  const auto message = [](const cv::Mat& earlier, const cv::Mat& current) {
    return test::invalidArgumentOf(
        [&] { filterDynamicFeatures(earlier, current, KeyPoints().view(), {}, fixedOptions()); });
  };
  EXPECT_EQ(message(gray, gray), "nothing thrown");
  EXPECT_NE(message(gray, color), "nothing thrown");
  EXPECT_NE(message(color, gray), "nothing thrown");
  EXPECT_NE(message(cv::Mat(), gray), "nothing thrown");
  EXPECT_NE(message(gray, large), "nothing thrown");
}

}  // namespace
}  // namespace hmcdyn

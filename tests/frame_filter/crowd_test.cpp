// SPDX-License-Identifier: BSD-3-Clause
// FrameFilter where boxes cover much of the image, or the detector says little.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include <hmcdyn/frame_filter.hpp>

#include "filmed_scene.hpp"

namespace hmcdyn {
namespace {

using test::FilmedScene;
using test::filterFilm;
using test::LayeredScene;

/// All but the lowest rows of key points, four of sixteen cells: too few to speak for the camera.
const std::vector<DetectionBox> kNearlyAll = {{0.0f, 0.0f, 319.0f, 205.0f}};

TEST(CrowdedFrame, WithoutAnybodyWhoKnowsTheResultSaysSoAndTheOutsideStays) {
  const FilmedScene film;
  FrameFilter filter;
  filter.filter(film.input(0), kNearlyAll);
  for (int f = 1; f < FilmedScene::kFrames; ++f) {
    const FrameFilterResult result = filter.filter(film.input(f), kNearlyAll);
    EXPECT_EQ(result.status, FrameFilterStatus::kCameraUnknown);
    std::size_t outside = 0;
    for (std::size_t i = 0; i < film.points.size(); ++i) {
      if (!kNearlyAll[0].contains(film.points.u[i], film.points.v[i])) {
        ++outside;
        EXPECT_EQ(result.label[i], PointLabel::kStatic);
        EXPECT_EQ(result.keep[i], 1);
        EXPECT_TRUE(std::isnan(result.details.distance[i]));
      }
    }
    EXPECT_GT(outside, 60U);
  }
}

// The camera moves by 2 cm a frame, and nobody but the few points outside the box says so, until it
// is known who stands still.
TEST(CrowdedFrame, WithTheCameraKnownTheMotionIsFoundAndJudgedBy) {
  const FilmedScene film;
  FrameFilterOptions options;
  options.camera = LayeredScene::kCamera;
  FrameFilter filter(options);
  filter.filter(film.input(0), kNearlyAll);
  FrameFilterResult result;
  for (int f = 1; f < FilmedScene::kFrames; ++f) {
    result = filter.filter(film.input(f), kNearlyAll);
    EXPECT_EQ(result.status, FrameFilterStatus::kFiltered);
    ASSERT_FALSE(result.details.earlier.empty());
    const EarlierFrameReport& neighbour = result.details.earlier[0];
    EXPECT_EQ(neighbour.motion.source, f == 1 ? MatchSource::kPrediction : MatchSource::kAtRest);
    EXPECT_TRUE(neighbour.camera_known);
    ASSERT_TRUE(neighbour.current_from_earlier);
    const Eigen::Isometry3d motion = *neighbour.current_from_earlier;
    EXPECT_NEAR(motion.translation().x(), film.scene.motionSince(1).translation().x(), 0.002);
  }
  int thing = 0;
  int kept_of_thing = 0;
  int walls = 0;
  int kept_of_walls = 0;
  for (std::size_t i = 0; i < film.points.size(); ++i) {
    (film.isThing(i) ? thing : walls) += 1;
    (film.isThing(i) ? kept_of_thing : kept_of_walls) += result.keep[i];
  }
  EXPECT_LE(kept_of_thing, thing / 10);
  EXPECT_GE(kept_of_walls, walls * 8 / 10);
}

TEST(CrowdedFrame, GivenPosesTheFilterGoesByThem) {
  const FilmedScene film;
  FrameFilterOptions options;
  options.camera = LayeredScene::kCamera;
  FrameFilter filter(options);
  FrameFilterResult result;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d(5.0, -3.0, 1.0);  // a world of the tracker's
  for (int f = 0; f < FilmedScene::kFrames; ++f) {
    FrameInput input = film.input(f);
    input.predicted_pose = Pose(pose);
    result = filter.filter(input, kNearlyAll);
    filter.setPose(input.timestamp, Pose(pose));
    pose = film.scene.motionSince(1) * pose;
  }
  EXPECT_EQ(result.status, FrameFilterStatus::kFiltered);
  ASSERT_TRUE(result.details.earlier[0].current_from_earlier);
  const Eigen::Isometry3d motion = *result.details.earlier[0].current_from_earlier;
  EXPECT_NEAR(motion.translation().x(), film.scene.motionSince(1).translation().x(), 0.002);
}

// The front end sets the pose of frame 0 and then finds nothing of its map.
TEST(CameraOfFrameFilter, IsInTheWorldOfTheLastPoseThatWasSet) {
  const FilmedScene film;
  FrameFilterOptions options;
  options.camera = LayeredScene::kCamera;
  FrameFilter filter(options);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d(5.0, -3.0, 1.0);
  for (int f = 0; f < FilmedScene::kFrames; ++f) {
    const FrameInput input = film.input(f);
    const FrameFilterResult result = filter.filter(input, film.boxes);
    ASSERT_TRUE(result.camera_from_world) << "frame " << f;
    if (f == 0) {
      EXPECT_TRUE(
          Eigen::Isometry3d(*result.camera_from_world).isApprox(Eigen::Isometry3d::Identity()))
          << "the first frame is the world's origin";
      filter.setPose(input.timestamp, Pose(pose));
      continue;
    }
    pose = film.scene.motionSince(1) * pose;
    const Eigen::Isometry3d found(*result.camera_from_world);
    EXPECT_LT((found.translation() - pose.translation()).norm(), 0.003 * f) << "frame " << f;
  }
}

TEST(CameraOfFrameFilter, IsNotGivenWhereAWorldOfTheFiltersOwnBegan) {
  const FilmedScene film;
  FrameFilterOptions options;
  options.camera = LayeredScene::kCamera;
  options.baselines = {0.0};
  FrameFilter filter(options);
  filter.filter(film.input(0), film.boxes);
  FrameInput blank = film.input(1);
  blank.gray = cv::Mat::zeros(blank.gray.size(), CV_8UC1);
  blank.timestamp = 1.0;  // frame 0 is forgotten
  EXPECT_FALSE(filter.filter(blank, film.boxes).camera_from_world);
  blank.timestamp = 2.0;
  EXPECT_FALSE(filter.filter(blank, film.boxes).camera_from_world);
  FrameInput input = film.input(2);
  input.timestamp = 3.0;
  EXPECT_FALSE(filter.filter(input, film.boxes).camera_from_world);
  filter.setPose(3.0, Pose());
  input = film.input(3);
  input.timestamp = 3.0 + 1.0 / 30.0;
  EXPECT_TRUE(filter.filter(input, film.boxes).camera_from_world);
}

TEST(CameraOfFrameFilter, IsNotGivenByTheRuleNoneOrWithoutACamera) {
  const FilmedScene film;
  FrameFilterOptions none;
  none.camera = LayeredScene::kCamera;
  none.rule = FilterRule::kNone;
  for (const FrameFilterOptions& options : {none, FrameFilterOptions()}) {
    FrameFilter filter(options);
    filter.filter(film.input(0), film.boxes);
    EXPECT_FALSE(filter.filter(film.input(1), film.boxes).camera_from_world);
  }
}

TEST(StarvedFrame, TheLeastMovingOfTheDroppedAreKeptAtLowWeight) {
  // Given how many are kept where nobody is kept for the number
  const FilmedScene film;
  FrameFilterOptions options;
  options.min_kept = 0;
  FrameFilter free(options);
  const FrameFilterResult before = filterFilm(free, film, film.boxes);
  ASSERT_EQ(before.kept_for_number, 0U);
  // When five more are wanted
  options.min_kept = static_cast<int>(before.kept) + 5;
  FrameFilter filter(options);
  const FrameFilterResult result = filterFilm(filter, film, film.boxes);
  // Then
  EXPECT_EQ(result.kept, before.kept + 5);
  EXPECT_EQ(result.kept_for_number, 5U);
  float most_of_kept = 0.0f;
  float least_of_dropped = 1.0f;
  for (std::size_t i = 0; i < film.points.size(); ++i) {
    if (before.keep[i] != 0) {
      EXPECT_EQ(result.weight[i], before.weight[i]);
      EXPECT_EQ(result.reason[i], before.reason[i]);
      continue;
    }
    const MotionBelief& belief = result.details.belief;
    const float against = belief.belief[i] * (0.1f + belief.weight[i]);
    if (result.keep[i] != 0) {
      EXPECT_EQ(result.weight[i], kRescueWeight);
      EXPECT_EQ(result.lambda[i], 0.0f);
      EXPECT_EQ(result.label[i], before.label[i]);
      EXPECT_EQ(result.reason[i], PointReason::kForNumber);
      most_of_kept = std::max(most_of_kept, std::isnan(against) ? 0.0f : against);
    } else {
      least_of_dropped = std::min(least_of_dropped, std::isnan(against) ? 1.0f : against);
    }
  }
  EXPECT_LE(most_of_kept, least_of_dropped);
}

TEST(StarvedFrame, WhereAllAreTooFewAllAreKept) {
  const FilmedScene film;
  FrameFilterOptions options;
  options.min_kept = 1 << 20;
  FrameFilter filter(options);
  const FrameFilterResult result = filterFilm(filter, film, film.boxes);
  EXPECT_EQ(result.kept, film.points.size());
  EXPECT_GT(result.kept_for_number, 50U);
}

TEST(SparseDetections, AreBridgedInside) {
  const FilmedScene film;
  FrameFilter filter;
  for (int f = 0; f < FilmedScene::kFrames; ++f) {
    const bool seen = f % 2 == 0;
    const FrameFilterResult result =
        filter.filter(film.input(f), seen ? film.boxes : std::vector<DetectionBox>{});
    ASSERT_EQ(result.boxes.size(), 1U) << f;
    EXPECT_EQ(result.bridged, seen ? 0U : 1U) << f;
  }
  FrameFilterOptions options;
  options.bridge = 0.0;
  FrameFilter never(options);
  never.filter(film.input(0), film.boxes);
  EXPECT_TRUE(never.filter(film.input(1), std::vector<DetectionBox>{}).boxes.empty());
}

TEST(SparseDetections, AFrameThatTheDetectorHasNotSeenTakesTheLastBoxesAlong) {
  const FilmedScene film;
  FrameFilter filter;
  filter.filter(film.input(0), film.boxes);
  const FrameFilterResult result = filter.filter(film.input(1));
  ASSERT_EQ(result.boxes.size(), 1U);
  EXPECT_EQ(result.bridged, 0U);  // nobody missed it
}

TEST(OwnMatches, AreNotFollowedAgainAndTheRestIs) {
  const FilmedScene film;
  FrameFilter filter;
  filterFilm(filter, film, film.boxes);
  FrameFilter with_matches;
  FrameFilterResult result;
  for (int f = 0; f < FilmedScene::kFrames; ++f) {
    FrameInput input = film.input(f);
    std::vector<cv::Point2f> pixels;
    for (std::size_t i = 0; i < film.points.size(); ++i) {
      pixels.emplace_back(i % 2 == 0 ? film.points.u[i] + 1.25f : kNaN, film.points.v[i]);
    }
    input.matched_timestamp = (f - 1) / 30.0;
    input.matched_pixels = pixels;
    result = with_matches.filter(input, film.boxes);
  }
  const FlowMatches& flow = result.details.earlier[0].flow;
  std::size_t given = 0;
  std::size_t followed = 0;
  for (std::size_t i = 0; i < film.points.size(); ++i) {
    if (std::isnan(flow.u[i])) {
      continue;
    }
    if (i % 2 == 0) {
      EXPECT_EQ(flow.u[i], film.points.u[i] + 1.25f);
      EXPECT_EQ(flow.v[i], film.points.v[i]);
      ++given;
    } else {
      ++followed;
    }
  }
  EXPECT_GT(given, 50U);
  EXPECT_GT(followed, 50U);
}

TEST(Ablations, TakeTheirPartAwayFromBothModes) {
  for (const FrameFilterOptions& whole :
       {FrameFilterOptions::paper(), FrameFilterOptions::robust()}) {
    EXPECT_EQ(without(Ablation::kNone, whole).rule, FilterRule::kHmc);
    EXPECT_EQ(without(Ablation::kRs, whole).rule, FilterRule::kDynamicBox);
    EXPECT_EQ(without(Ablation::kDf, whole).rule, FilterRule::kEpipolar);
    EXPECT_EQ(without(Ablation::kOpw, whole).soft_weight_gate, 1.0);
    EXPECT_EQ(without(Ablation::kRs, whole).baselines, whole.baselines);
  }
}

TEST(FrameFilterSteps, AreTheExpertsWithWhatTheFirstFieldsSay) {
  FrameFilterOptions options;
  options.rule = FilterRule::kChiSquare;
  options.seed = 7;
  options.max_followed = 90;
  options.expert.stage.clustering.epsilon = 0.25f;
  options.expert.two_view.seed = 3;  // not asked
  const DynamicFeatureFilterOptions steps = options.steps();
  EXPECT_EQ(steps.stage.rule, FilterRule::kChiSquare);
  EXPECT_EQ(steps.two_view.seed, 7U);
  EXPECT_EQ(steps.stage.depth_ransac.seed, 7U);
  EXPECT_EQ(steps.flow_in_boxes, 50);
  EXPECT_EQ(steps.flow_background, 40);
  EXPECT_EQ(steps.stage.clustering.epsilon, 0.25f);
  // The defaults are those of filterDynamicFeatures()
  const DynamicFeatureFilterOptions usual = FrameFilterOptions().steps();
  EXPECT_EQ(usual.flow_in_boxes, DynamicFeatureFilterOptions().flow_in_boxes);
  EXPECT_EQ(usual.flow_background, DynamicFeatureFilterOptions().flow_background);
  EXPECT_EQ(usual.two_view.seed, DynamicFeatureFilterOptions().two_view.seed);
}

TEST(Ablations, RsDropsBoxesThatMoveAndNoOther) {
  FilmedScene film(FilmedScene::kForAllMatches);
  film.boxes.push_back({5.0f, 5.0f, 60.0f, 60.0f});  // wall
  FrameFilter filter(without(Ablation::kRs, FrameFilterOptions::paper()));
  const FrameFilterResult result = filterFilm(filter, film, film.boxes);
  const std::vector<BoxDecision>& boxes = result.details.stage.boxes;
  ASSERT_EQ(boxes.size(), 2U);
  EXPECT_TRUE(boxes[0].verdict.is_dynamic);
  for (std::size_t i = 0; i < film.points.size(); ++i) {
    bool dropped = false;
    for (std::size_t b = 0; b < boxes.size(); ++b) {
      dropped = dropped || (boxes[b].verdict.is_dynamic &&
                            film.boxes[b].contains(film.points.u[i], film.points.v[i]));
    }
    EXPECT_EQ(result.keep[i], dropped ? 0 : 1) << i;
  }
}

TEST(Ablations, OpwChangesTheRefinementAndNotWhatTheMapSees) {
  const FilmedScene film;
  FrameFilterOptions options = FrameFilterOptions::paper();
  options.soft_weight_gate = 0.0;
  FrameFilter whole(options);
  FrameFilter opw(without(Ablation::kOpw, options));
  const FrameFilterResult with = filterFilm(whole, film, film.boxes);
  const FrameFilterResult result = filterFilm(opw, film, film.boxes);
  EXPECT_EQ(result.lambda, with.lambda);
  EXPECT_EQ(with.weight, with.lambda);
  EXPECT_EQ(result.weight, hardWeights(Span<const float>(with.lambda)));
}

TEST(FeatureFactor, LeavesAsManyOutsideTheBoxes) {
  const std::vector<DetectionBox> half = {{0.0f, 0.0f, 319.0f, 239.0f}};
  EXPECT_DOUBLE_EQ(featureFactor({}, {640, 240}), 1.0);
  EXPECT_DOUBLE_EQ(featureFactor(half, {640, 240}), 2.0);
  EXPECT_DOUBLE_EQ(featureFactor(half, {320, 240}), 2.5);
  EXPECT_DOUBLE_EQ(featureFactor(half, {640, 240}, 1.5), 1.5);
  EXPECT_THROW(featureFactor(half, {640, 240}, 0.9), std::invalid_argument);
}

}  // namespace
}  // namespace hmcdyn

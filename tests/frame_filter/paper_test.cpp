// SPDX-License-Identifier: BSD-3-Clause
// FrameFilterOptions::paper() is the paper's method: equal, bit for bit, to its steps one by one.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include <hmcdyn/frame_filter.hpp>
#include <hmcdyn/hmcdyn.hpp>

#include "filmed_scene.hpp"

namespace hmcdyn {
namespace {

using test::FilmedScene;

struct Expected {
  std::vector<PointLabel> label;
  std::vector<float> lambda;
  std::size_t in_dynamic_boxes = 0;
};

/// Clusters, filters and weighs the points of one dynamic box (sections III-B to III-D).
void judgeBox(Span<const std::uint32_t> members, const KeyPoints& points,
              const std::vector<float>& distance, const std::vector<float>& threshold,
              float mean_distance, Expected& expected) {
  std::vector<float> depths, distances, thresholds;
  for (const std::uint32_t i : members) {
    depths.push_back(points.depth[i]);
    distances.push_back(distance[i]);
    thresholds.push_back(threshold[i]);
  }
  ClusteringWorkspace workspace;
  const Clustering& clustering = clusterBox(depths, distances, ClusteringOptions{}, workspace);
  ClusterFilterOptions rules;  // no floors, and nobody is placed by depth
  rules.min_strongest_distance = 0.0f;
  rules.screening_ratio = 1.0f;
  rules.screening_floor = 0.0f;
  rules.place_unmatched_by_depth = false;
  const ClusterFilterResult filtered =
      filterClusters(depths, distances, thresholds, clustering, mean_distance, rules);
  DepthAnchor anchor;
  anchor.sigma = detail::depthDeviation(depths);
  if (filtered.strongest != kNoise) {
    anchor.depth = filtered.clusters[static_cast<std::size_t>(filtered.strongest)].mean_depth;
  }
  const std::vector<float> weight = keptPointWeights(depths, anchor);
  for (std::size_t k = 0; k < members.size(); ++k) {
    const std::uint32_t i = members[k];
    if (filtered.is_dynamic[k] != 0 || expected.label[i] == PointLabel::kDynamic) {
      expected.label[i] = PointLabel::kDynamic;
      expected.lambda[i] = 0.0f;
    } else {
      expected.label[i] = std::isnan(distances[k]) ? PointLabel::kUnmatched : PointLabel::kSuspect;
      expected.lambda[i] = std::min(expected.lambda[i], weight[k]);
    }
  }
}

/// Section III of the paper on a frame and the one before it.
Expected stepByStep(const cv::Mat& before, const cv::Mat& now, const KeyPoints& points,
                    const std::vector<DetectionBox>& boxes) {
  OpticalFlowOptions exact_flow;
  exact_flow.epsilon = 0.01f;
  const FlowMatches flow = trackIntoEarlierFrame(buildFlowPyramid(now), buildFlowPyramid(before),
                                                 points.view(), exact_flow);
  const PointPairsView pairs{flow.u, flow.v, points.u, points.v};
  TwoViewOptions always_f;  // of all matches, whatever the camera did
  always_f.min_background_matches = 1 << 30;
  always_f.still_displacement = 0.0f;
  always_f.min_conditioning = 1.0f;
  always_f.max_iterations = 2000;
  const TwoViewEstimate motion = estimateTwoViewModel(pairs, {}, always_f);
  EXPECT_EQ(motion.model.kind, TwoViewModelKind::kFundamental);
  const std::vector<float> distance = epipolarDistances(motion.model.matrix, pairs);  // eq. 3-4
  const BoxMembership membership = assignToBoxes(points.view(), boxes);
  const BoxDynamism dynamism = testBoxes(distance, boxes, membership);
  std::size_t measured = 0;
  const float mean_distance = detail::meanDistance(distance, measured);

  Expected expected;
  expected.label.assign(points.size(), PointLabel::kStatic);
  expected.lambda.assign(points.size(), 1.0f);
  std::vector<std::uint8_t> inside(points.size(), 0);
  for (std::size_t b = 0; b < boxes.size(); ++b) {
    if (dynamism.boxes[b].is_dynamic) {
      judgeBox(membership.pointsIn(b), points, distance, dynamism.threshold, mean_distance,
               expected);
      for (const std::uint32_t i : membership.pointsIn(b)) {
        inside[i] = 1;
      }
    }
  }
  expected.in_dynamic_boxes =
      static_cast<std::size_t>(std::count(inside.begin(), inside.end(), std::uint8_t{1}));
  return expected;
}

class PaperMode : public testing::TestWithParam<double> {};

TEST_P(PaperMode, IsTheStepsOfThePaperOneByOne) {
  // Given a thing that moves, in two boxes that overlap, and a box of wall
  FilmedScene film(FilmedScene::kForAllMatches);
  DetectionBox half = film.boxes[0];
  half.y_min = 0.5f * (half.y_min + half.y_max);
  half.x_max += 30.0f;
  half.class_id = 56;
  film.boxes.push_back(half);
  film.boxes.push_back({5.0f, 5.0f, 60.0f, 90.0f});
  FrameFilterOptions options = FrameFilterOptions::paper();
  options.soft_weight_gate = GetParam();
  FrameFilter filter(options);
  std::size_t dynamic = 0;
  bool soft = false;
  for (int f = 0; f < FilmedScene::kFrames; ++f) {
    // When
    const FrameInput input = film.input(f);
    const FrameFilterResult result = filter.filter(input, film.boxes);
    if (f == 0) {
      EXPECT_EQ(result.keep, std::vector<std::uint8_t>(film.points.size(), 1));
      continue;
    }
    // Then
    KeyPoints points = film.points;
    for (std::size_t i = 0; i < points.size(); ++i) {
      points.depth[i] =
          input.depth.at<float>(static_cast<int>(points.v[i]), static_cast<int>(points.u[i]));
    }
    const Expected expected = stepByStep(film.input(f - 1).gray, input.gray, points, film.boxes);
    EXPECT_EQ(result.label, expected.label) << "frame " << f;
    EXPECT_EQ(result.lambda, expected.lambda) << "frame " << f;
    const bool gate =
        useSoftWeights(expected.in_dynamic_boxes, points.size(), options.soft_weight_gate);
    EXPECT_EQ(result.soft_weights, gate) << "frame " << f;
    EXPECT_EQ(result.weight,
              gate ? expected.lambda : hardWeights(Span<const float>(expected.lambda)))
        << "frame " << f;
    dynamic += static_cast<std::size_t>(
        std::count(result.label.begin(), result.label.end(), PointLabel::kDynamic));
    soft = soft || result.soft_weights;
  }
  EXPECT_GT(dynamic, 100U);
  EXPECT_EQ(soft, GetParam() < 0.5);
}

INSTANTIATE_TEST_SUITE_P(BelowAndAboveTheGate, PaperMode, testing::Values(0.6, 0.0));

}  // namespace
}  // namespace hmcdyn

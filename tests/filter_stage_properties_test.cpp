// SPDX-License-Identifier: BSD-3-Clause
// Properties of the filter stage over random frames.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include <hmcdyn/filter_stage.hpp>

#include "filter_options.hpp"
#include "random.hpp"
#include "random_frame.hpp"

namespace hmcdyn {
namespace {

using test::fixedStageOptions;
using test::Frame;
using test::Random;

constexpr int kFrames = 150;

void expectSameDecision(const FilterStageResult& actual, const FilterStageResult& expected) {
  EXPECT_EQ(actual.label, expected.label);
  EXPECT_EQ(actual.weight, expected.weight);
  EXPECT_EQ(actual.cluster, expected.cluster);
  EXPECT_EQ(actual.frame.mean_distance, expected.frame.mean_distance);
  EXPECT_EQ(actual.frame.dynamic, expected.frame.dynamic);
  EXPECT_EQ(actual.frame.suspect, expected.frame.suspect);
  EXPECT_EQ(actual.frame.unmatched, expected.frame.unmatched);
  EXPECT_EQ(actual.frame.dynamic_boxes, expected.frame.dynamic_boxes);
  EXPECT_EQ(actual.frame.points_in_dynamic_boxes, expected.frame.points_in_dynamic_boxes);
  ASSERT_EQ(actual.boxes.size(), expected.boxes.size());
  for (std::size_t b = 0; b < actual.boxes.size(); ++b) {
    EXPECT_EQ(actual.boxes[b].verdict.is_dynamic, expected.boxes[b].verdict.is_dynamic);
    EXPECT_EQ(actual.boxes[b].clusters.size(), expected.boxes[b].clusters.size());
    EXPECT_EQ(actual.boxes[b].first_cluster, expected.boxes[b].first_cluster);
    EXPECT_EQ(actual.boxes[b].strongest, expected.boxes[b].strongest);
    EXPECT_EQ(actual.boxes[b].anchor.sigma, expected.boxes[b].anchor.sigma);
  }
}

/// Labels and weights by calling each step, box by box, and keeping the strictest verdict.
struct Composed {
  std::vector<PointLabel> label;
  std::vector<double> weight;
};

Composed composeSteps(const Frame& frame, const FilterStageOptions& options) {
  const std::size_t n = frame.points.size();
  Composed composed{std::vector<PointLabel>(n, PointLabel::kStatic), std::vector<double>(n, 1.0)};
  double sum = 0.0;
  int measured = 0;
  for (const float d : frame.distance) {
    sum += std::isnan(d) ? 0.0 : d;
    measured += std::isnan(d) ? 0 : 1;
  }
  const auto mean = measured > 0 ? static_cast<float>(sum / measured) : 0.0f;
  const BoxMembership membership = assignToBoxes(frame.points.view(), frame.boxes);
  const BoxDynamism dynamism = testBoxes(frame.distance, frame.boxes, membership, options.boxes);
  for (std::size_t b = 0; b < frame.boxes.size(); ++b) {
    if (!dynamism.boxes[b].is_dynamic) {
      continue;
    }
    std::vector<float> depth, distance, threshold, depths_there;
    for (const std::uint32_t i : membership.pointsIn(b)) {
      depth.push_back(frame.points.depth[i]);
      distance.push_back(frame.distance[i]);
      threshold.push_back(dynamism.threshold[i]);
      if (hasDepth(depth.back())) {
        depths_there.push_back(depth.back());
      }
    }
    const Clustering clusters = clusterBox(depth, distance, options.clustering);
    const ClusterFilterResult filtered =
        filterClusters(depth, distance, threshold, clusters, mean, options.cluster_filter);
    DepthAnchor anchor;
    if (filtered.strongest != kNoise) {
      anchor.depth = filtered.clusters[static_cast<std::size_t>(filtered.strongest)].mean_depth;
    }
    if (!depths_there.empty()) {
      const Eigen::ArrayXd z =
          Eigen::Map<Eigen::ArrayXf>(depths_there.data(),
                                     static_cast<Eigen::Index>(depths_there.size()))
              .cast<double>();
      anchor.sigma = static_cast<float>(std::sqrt((z - z.mean()).square().mean()));
    }
    for (std::size_t k = 0; k < depth.size(); ++k) {
      const std::uint32_t i = membership.pointsIn(b)[k];
      const bool dynamic = filtered.is_dynamic[k] != 0 || composed.label[i] == PointLabel::kDynamic;
      const double weight = keptPointWeight(depth[k], anchor, options.weights);
      composed.weight[i] = dynamic ? 0.0 : std::min(composed.weight[i], weight);
      composed.label[i] = dynamic                   ? PointLabel::kDynamic
                          : std::isnan(distance[k]) ? PointLabel::kUnmatched
                                                    : PointLabel::kSuspect;
    }
  }
  return composed;
}

TEST(FilterStageProperties, EqualsTheStepsOneByOne) {
  Random random(41);
  const FilterStageOptions options = fixedStageOptions(FilterRule::kHmc);
  std::size_t dynamic = 0, suspect = 0, unmatched = 0, anchors = 0;
  for (int trial = 0; trial < kFrames; ++trial) {
    const Frame frame = test::makeFrame(random);
    const FilterStageResult result = frame.filter(options);
    const Composed expected = composeSteps(frame, options);
    ASSERT_EQ(result.label, expected.label) << "frame " << trial;
    for (std::size_t i = 0; i < expected.weight.size(); ++i) {
      ASSERT_NEAR(result.weight[i], expected.weight[i], 1e-5)
          << "frame " << trial << " point " << i;
    }
    dynamic += result.frame.dynamic;
    suspect += result.frame.suspect;
    unmatched += result.frame.unmatched;
    for (const BoxDecision& box : result.boxes) {
      anchors += box.strongest != kNoise ? 1 : 0;
    }
  }
  // The frames are worth their name.
  EXPECT_GT(dynamic, 1000U);
  EXPECT_GT(suspect, 1000U);
  EXPECT_GT(unmatched, 200U);
  EXPECT_GT(anchors, 50U);
}

TEST(FilterStageProperties, AReusedWorkspaceGivesWhatAFreshOneGives) {
  Random random(42);
  FilterStageWorkspace workspace;
  for (int trial = 0; trial < kFrames; ++trial) {
    const Frame frame = test::makeFrame(random);
    const FilterStageOptions options = fixedStageOptions(kFilterRules[random.integer(0, 6)]);
    SCOPED_TRACE("frame " + std::to_string(trial) + ", rule " + toString(options.rule));
    const FilterStageResult& reused =
        filterKeyPoints(frame.points.view(), frame.distance, frame.boxes, options, workspace);
    expectSameDecision(reused, frame.filter(options));
  }
}

TEST(FilterStageProperties, ResultsFollowThePointsInAnyOrder) {
  Random random(43);
  for (int trial = 0; trial < kFrames; ++trial) {
    const Frame frame = test::makeFrame(random);
    const std::vector<std::size_t> order = random.permutation(frame.points.size());
    Frame shuffled;
    shuffled.boxes = frame.boxes;
    for (const std::size_t i : order) {
      shuffled.points.push_back(frame.points.u[i], frame.points.v[i], frame.points.depth[i]);
      shuffled.distance.push_back(frame.distance[i]);
    }
    // Not depth_ransac, whose draws are positions in the list of points.
    for (const FilterRule rule : {FilterRule::kHmc, FilterRule::kBox, FilterRule::kEpipolar,
                                  FilterRule::kTwoThreshold, FilterRule::kChiSquare}) {
      const FilterStageResult expected = frame.filter(fixedStageOptions(rule));
      const FilterStageResult actual = shuffled.filter(fixedStageOptions(rule));
      for (std::size_t i = 0; i < order.size(); ++i) {
        ASSERT_EQ(actual.label[i], expected.label[order[i]]) << toString(rule) << " " << trial;
        // Sums of another order differ in their last digits.
        ASSERT_NEAR(actual.weight[i], expected.weight[order[i]], 1e-4) << toString(rule);
        ASSERT_EQ(actual.cluster[i], expected.cluster[order[i]]) << toString(rule);
      }
    }
  }
}

TEST(FilterStageProperties, TheOrderOfTheBoxesDoesNotMatter) {
  Random random(44);
  for (int trial = 0; trial < kFrames; ++trial) {
    const Frame frame = test::makeFrame(random);
    Frame shuffled = frame;
    const std::vector<std::size_t> order = random.permutation(frame.boxes.size());
    for (std::size_t b = 0; b < order.size(); ++b) {
      shuffled.boxes[b] = frame.boxes[order[b]];
    }
    for (const FilterRule rule : {FilterRule::kHmc, FilterRule::kBox, FilterRule::kEpipolar,
                                  FilterRule::kTwoThreshold, FilterRule::kChiSquare}) {
      const FilterStageResult expected = frame.filter(fixedStageOptions(rule));
      const FilterStageResult actual = shuffled.filter(fixedStageOptions(rule));
      EXPECT_EQ(actual.label, expected.label) << toString(rule) << ", frame " << trial;
      EXPECT_EQ(actual.weight, expected.weight) << toString(rule) << ", frame " << trial;
      EXPECT_EQ(actual.frame.dynamic_boxes, expected.frame.dynamic_boxes);
    }
  }
}

TEST(FilterStageProperties, MovingTheImageAndItsBoxesChangesNothing) {
  Random random(45);
  for (int trial = 0; trial < kFrames; ++trial) {
    // Given pixels and borders in multiples of 1/8, which a shift by whole pixels keeps exact
    Frame frame = test::makeFrame(random);
    for (DetectionBox& box : frame.boxes) {
      for (float* border : {&box.x_min, &box.y_min, &box.x_max, &box.y_max}) {
        *border = std::round(*border * 8.0f) / 8.0f;
      }
    }
    const auto dx = static_cast<float>(random.integer(-2000, 2000));
    const auto dy = static_cast<float>(random.integer(-2000, 2000));
    Frame moved = frame;
    for (std::size_t i = 0; i < moved.points.size(); ++i) {
      moved.points.u[i] += dx;
      moved.points.v[i] += dy;
    }
    for (DetectionBox& box : moved.boxes) {
      box.x_min += dx;
      box.x_max += dx;
      box.y_min += dy;
      box.y_max += dy;
    }
    for (const FilterRule rule : kFilterRules) {
      SCOPED_TRACE(toString(rule));
      expectSameDecision(moved.filter(fixedStageOptions(rule)),
                         frame.filter(fixedStageOptions(rule)));
    }
  }
}

TEST(FilterStageProperties, WeightsAreWithinZeroAndOneAndFollowTheLabels) {
  Random random(46);
  for (int trial = 0; trial < kFrames; ++trial) {
    const Frame frame = test::makeFrame(random);
    for (const FilterRule rule : kFilterRules) {
      const FilterStageResult result = frame.filter(fixedStageOptions(rule));
      for (std::size_t i = 0; i < result.weight.size(); ++i) {
        ASSERT_TRUE(result.weight[i] >= 0.0f && result.weight[i] <= 1.0f);
        if (result.label[i] == PointLabel::kStatic) {
          ASSERT_EQ(result.weight[i], 1.0f);
        } else if (result.label[i] == PointLabel::kDynamic) {
          ASSERT_EQ(result.weight[i], 0.0f);
        }
      }
    }
  }
}

}  // namespace
}  // namespace hmcdyn

// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <hmcdyn/steps/cluster_filter.hpp>

#include "invalid_argument.hpp"

namespace hmcdyn {
namespace {

/// Points of one box with the clusters they are in. Every threshold is 1 px.
struct Box {
  std::vector<float> depth, distance, threshold;
  Clustering clustering;

  /// A cluster of a point a distance, at depths spread evenly over [near, far].
  Box& cluster(float near, float far, const std::vector<float>& distances) {
    for (std::size_t i = 0; i < distances.size(); ++i) {
      const float share = distances.size() == 1
                              ? 0.5f
                              : static_cast<float>(i) / static_cast<float>(distances.size() - 1);
      add(near + share * (far - near), distances[i], clustering.clusters);
    }
    ++clustering.clusters;
    return *this;
  }
  Box& noise(float z, float d) {
    add(z, d, kNoise);
    return *this;
  }

  ClusterFilterResult filter(float frame_mean, const ClusterFilterOptions& options) const {
    return filterClusters(depth, distance, threshold, clustering, frame_mean, options);
  }

 private:
  void add(float z, float d, int label) {
    depth.push_back(z);
    distance.push_back(d);
    threshold.push_back(1.0f);
    clustering.label.push_back(label);
    clustering.is_core.push_back(1);
  }
};

/// The rules as the paper has them: no floors, no placing by depth.
ClusterFilterOptions paperRules() {
  ClusterFilterOptions options;
  options.min_cluster_size = 3;
  options.min_strongest_distance = 0.0f;
  options.screening_ratio = 1.0f;
  options.screening_floor = 0.0f;
  options.place_unmatched_by_depth = false;
  return options;
}

/// A frame's mean distance that no cluster of these tests exceeds.
constexpr float kNothingScreened = 100.0f;

std::vector<ClusterVerdict> verdicts(const ClusterFilterResult& result) {
  std::vector<ClusterVerdict> all;
  for (const ClusterSummary& cluster : result.clusters) {
    all.push_back(cluster.verdict);
  }
  return all;
}

std::vector<std::uint8_t> flags(std::initializer_list<int> values) {
  return {values.begin(), values.end()};
}

using V = ClusterVerdict;

TEST(ClusterFilter, SummarisesEachCluster) {
  const Box box = Box().cluster(1.0f, 3.0f, {0.5f, 1.0f, 3.0f}).noise(9.0f, 50.0f);
  const ClusterFilterResult result = box.filter(kNothingScreened, paperRules());
  ASSERT_EQ(result.clusters.size(), 1U);
  EXPECT_EQ(result.clusters[0].points, 3U);
  EXPECT_FLOAT_EQ(result.clusters[0].mean_distance, 1.5f);
  EXPECT_FLOAT_EQ(result.clusters[0].mean_depth, 2.0f);
  EXPECT_FLOAT_EQ(result.clusters[0].min_depth, 1.0f);
  EXPECT_FLOAT_EQ(result.clusters[0].max_depth, 3.0f);
}

TEST(ClusterFilter, RuleAAnchorsAtTheLargestMeanAmongLargeClusters) {
  // Given a fast cluster that is too small, and two that are large enough, all below 1 px.
  const Box box = Box()
                      .cluster(1.0f, 1.1f, {0.4f, 0.4f, 0.4f})
                      .cluster(3.0f, 3.1f, {0.6f, 0.6f, 0.6f})
                      .cluster(5.0f, 5.1f, {0.9f, 0.9f});
  const ClusterFilterResult result = box.filter(kNothingScreened, paperRules());
  EXPECT_EQ(result.strongest, 1);
  EXPECT_EQ(verdicts(result), (std::vector<V>{V::kStatic, V::kStrongest, V::kStatic}));
  EXPECT_EQ(result.is_dynamic, flags({0, 0, 0, 1, 1, 1, 0, 0}));
}

TEST(ClusterFilter, RuleAPrefersTheNearerClusterAtATie) {
  const Box box =
      Box().cluster(1.0f, 1.1f, {0.5f, 0.5f, 0.5f}).cluster(3.0f, 3.1f, {0.5f, 0.5f, 0.5f});
  EXPECT_EQ(box.filter(kNothingScreened, paperRules()).strongest, 0);
}

TEST(ClusterFilter, RuleANeedsTheLeastMeanDistance) {
  const Box box = Box().cluster(1.0f, 1.1f, {0.5f, 0.5f, 0.5f});
  ClusterFilterOptions options = paperRules();
  options.min_strongest_distance = 0.5f;
  EXPECT_EQ(box.filter(kNothingScreened, options).strongest, 0);
  options.min_strongest_distance = 0.51f;
  EXPECT_EQ(box.filter(kNothingScreened, options).strongest, kNoise);
}

TEST(ClusterFilter, RuleBScreensClustersAboveTheFramesMean) {
  // Given clusters far apart in depth: 0.3 and 0.31 px around a frame's mean of 0.3 px.
  const Box box = Box()
                      .cluster(1.0f, 1.1f, {0.9f, 0.9f, 0.9f})
                      .cluster(3.0f, 3.1f, {0.3f, 0.3f, 0.3f})
                      .cluster(5.0f, 5.1f, {0.31f, 0.31f});
  const ClusterFilterResult result = box.filter(0.3f, paperRules());
  // Then the mean itself does not exceed the mean; size does not matter here.
  EXPECT_EQ(verdicts(result), (std::vector<V>{V::kStrongest, V::kStatic, V::kScreened}));
  EXPECT_EQ(result.is_dynamic, flags({1, 1, 1, 0, 0, 0, 1, 1}));
}

TEST(ClusterFilter, RuleBTakesTheRatioAndTheFloor) {
  const Box box =
      Box().cluster(1.0f, 1.1f, {0.9f, 0.9f, 0.9f}).cluster(5.0f, 5.1f, {0.4f, 0.4f, 0.4f});
  const auto second = [&](float ratio, float floor) {
    ClusterFilterOptions options = paperRules();
    options.screening_ratio = ratio;
    options.screening_floor = floor;
    return box.filter(0.15f, options).clusters[1].verdict;
  };
  EXPECT_EQ(second(1.0f, 0.0f), V::kScreened);
  EXPECT_EQ(second(2.0f, 0.0f), V::kScreened);  // 0.4 > 0.30
  EXPECT_EQ(second(3.0f, 0.0f), V::kStatic);    // 0.4 < 0.45
  EXPECT_EQ(second(1.0f, 0.39f), V::kScreened);
  EXPECT_EQ(second(1.0f, 0.41f), V::kStatic);
}

TEST(ClusterFilter, RuleCTakesClustersAsDeepAsTheStrongest) {
  // Given an anchor from 2 m to 3 m: mean 2.5 m, extent 1 m. Mean depths 1.51 and 3.49 m are
  // nearer than that, 1.5 and 3.5 m are not.
  const Box box = Box()
                      .cluster(2.0f, 3.0f, {0.9f, 0.9f, 0.9f})
                      .cluster(1.51f, 1.51f, {0.1f, 0.1f})
                      .cluster(3.49f, 3.49f, {0.1f, 0.1f})
                      .cluster(1.5f, 1.5f, {0.1f, 0.1f})
                      .cluster(3.5f, 3.5f, {0.1f, 0.1f});
  const ClusterFilterResult result = box.filter(kNothingScreened, paperRules());
  EXPECT_EQ(verdicts(result), (std::vector<V>{V::kStrongest, V::kDepthNeighbour, V::kDepthNeighbour,
                                              V::kStatic, V::kStatic}));
  EXPECT_EQ(result.is_dynamic, flags({1, 1, 1, 1, 1, 1, 1, 0, 0, 0, 0}));
}

TEST(ClusterFilter, RuleCReachesNobodyFromAFlatAnchor) {
  const Box box =
      Box().cluster(2.0f, 2.0f, {0.9f, 0.9f, 0.9f}).cluster(2.0f, 2.0f, {0.1f, 0.1f, 0.1f});
  EXPECT_EQ(verdicts(box.filter(kNothingScreened, paperRules())),
            (std::vector<V>{V::kStrongest, V::kStatic}));
}

TEST(ClusterFilter, RuleDSweepsPointsBeyondTheirOwnThreshold) {
  // Given a static cluster and noise with single points beyond 1 px, or beyond a stricter
  // threshold.
  Box box = Box()
                .cluster(1.0f, 1.1f, {0.9f, 0.9f, 0.9f})
                .cluster(5.0f, 5.1f, {0.1f, 1.01f, 0.1f, 0.95f})
                .noise(7.0f, 1.5f)
                .noise(8.0f, 1.0f)
                .noise(0.0f, 1.2f)
                .noise(kNaN, 0.8f);
  box.threshold[6] = 0.9f;
  const ClusterFilterResult result = box.filter(kNothingScreened, paperRules());
  EXPECT_EQ(result.clusters[1].verdict, V::kStatic);
  EXPECT_EQ(result.is_dynamic, flags({1, 1, 1, 0, 1, 0, 1, 1, 0, 1, 0}));
}

TEST(ClusterFilter, WithoutAnAnchorOnlyRuleDApplies) {
  // Given clusters that are too small, above the frame's mean and side by side in depth.
  const Box box = Box()
                      .cluster(2.0f, 3.0f, {0.9f, 1.1f})
                      .cluster(2.2f, 2.8f, {0.8f, 0.8f})
                      .noise(2.5f, 2.0f)
                      .noise(2.5f, kNaN);
  ClusterFilterOptions options = paperRules();
  options.place_unmatched_by_depth = true;
  const ClusterFilterResult result = box.filter(0.1f, options);
  EXPECT_EQ(result.strongest, kNoise);
  EXPECT_EQ(verdicts(result), (std::vector<V>{V::kStatic, V::kStatic}));
  EXPECT_EQ(result.is_dynamic, flags({0, 1, 0, 0, 1, 0}));
}

TEST(ClusterFilter, PapersRuleAnchorsInABoxThatStandsStill) {
  // Given two clusters that hardly move; the paper has no floor, so the larger mean anchors, and
  // its depth neighbour goes, too.
  const Box box =
      Box().cluster(2.0f, 3.0f, {0.02f, 0.02f, 0.02f}).cluster(2.5f, 2.6f, {0.01f, 0.01f, 0.01f});
  EXPECT_EQ(verdicts(box.filter(0.05f, paperRules())),
            (std::vector<V>{V::kStrongest, V::kDepthNeighbour}));
  // A floor keeps both.
  ClusterFilterOptions options = paperRules();
  options.min_strongest_distance = 0.5f;
  EXPECT_EQ(verdicts(box.filter(0.05f, options)), (std::vector<V>{V::kStatic, V::kStatic}));
}

TEST(ClusterFilter, LostMatchesArePlacedByTheirDepth) {
  // Given dynamic clusters at 1-2 m and 5-6 m, a static one at 8-9 m, and points without distance.
  const Box box = Box()
                      .cluster(1.0f, 2.0f, {0.9f, 0.9f, 0.9f})
                      .cluster(5.0f, 6.0f, {0.5f, 0.5f, 0.5f})
                      .cluster(8.0f, 9.0f, {0.1f, 0.1f, 0.1f})
                      .noise(1.0f, kNaN)  // at the border
                      .noise(5.5f, kNaN)  // in the screened cluster
                      .noise(3.0f, kNaN)  // between
                      .noise(8.5f, kNaN)  // in the static cluster
                      .noise(0.0f, kNaN)  // no depth
                      .noise(kNaN, kNaN)
                      .noise(1.5f, 0.2f);  // has a distance: that decides
  ClusterFilterOptions options = paperRules();
  options.place_unmatched_by_depth = true;
  const ClusterFilterResult placed = box.filter(0.3f, options);
  EXPECT_EQ(verdicts(placed), (std::vector<V>{V::kStrongest, V::kScreened, V::kStatic}));
  EXPECT_EQ(placed.is_dynamic, flags({1, 1, 1, 1, 1, 1, 0, 0, 0, 1, 1, 0, 0, 0, 0, 0}));
  options.place_unmatched_by_depth = false;
  EXPECT_EQ(box.filter(0.3f, options).is_dynamic,
            flags({1, 1, 1, 1, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}));
}

TEST(ClusterFilter, NoPointsAndNoClustersAreFine) {
  const ClusterFilterResult result = Box().filter(0.0f, paperRules());
  EXPECT_TRUE(result.clusters.empty());
  EXPECT_TRUE(result.is_dynamic.empty());
  EXPECT_EQ(result.strongest, kNoise);
}

TEST(ClusterFilter, ReusedMemoryLeavesNothingBehind) {
  const Box big = Box()
                      .cluster(1.0f, 2.0f, {0.9f, 0.9f, 0.9f})
                      .cluster(1.5f, 2.0f, {5.0f, 5.0f, 5.0f})
                      .noise(1.0f, 9.0f);
  const Box small = Box().cluster(1.0f, 2.0f, {0.1f, 0.1f});
  const ClusterFilterResult result =
      filterClusters(small.depth, small.distance, small.threshold, small.clustering, 0.0f,
                     paperRules(), big.filter(0.0f, paperRules()));
  EXPECT_EQ(result.strongest, kNoise);
  EXPECT_EQ(verdicts(result), std::vector<V>{V::kStatic});
  EXPECT_EQ(result.is_dynamic, flags({0, 0}));
}

TEST(ClusterFilter, UnequalSizesAreRefused) {
  const Box good = Box().cluster(1.0f, 2.0f, {0.9f, 0.9f, 0.9f});
  Box box = good;
  box.threshold.pop_back();
  EXPECT_EQ(test::invalidArgumentOf([&] { box.filter(0.0f, paperRules()); }),
            "filterClusters: 3 depths, 3 distances, 2 thresholds, 3 cluster labels; expected equal "
            "sizes");
  box = good;
  box.distance.push_back(1.0f);
  EXPECT_NE(test::invalidArgumentOf([&] { box.filter(0.0f, paperRules()); }), "nothing thrown");
  box = good;
  box.clustering.label.pop_back();
  EXPECT_NE(test::invalidArgumentOf([&] { box.filter(0.0f, paperRules()); }), "nothing thrown");
}

TEST(ClusterFilter, ALabelBeyondTheClustersIsRefused) {
  Box box;
  box.cluster(2.0f, 2.1f, {2.0f, 2.0f, 2.0f});  // labels 0, of one cluster
  const Box good = box;
  box.clustering.label[1] = 7;
  EXPECT_EQ(test::invalidArgumentOf([&] { box.filter(0.0f, paperRules()); }),
            "filterClusters: cluster labels reach from 0 to 7 in a clustering of 1 clusters; "
            "expected -1 (noise), or a number below that of the clusters");
  box = good;
  box.clustering.label[1] = -2;
  EXPECT_NE(test::invalidArgumentOf([&] { box.filter(0.0f, paperRules()); }), "nothing thrown");
  box = good;
  box.clustering.clusters = 0;
  EXPECT_NE(test::invalidArgumentOf([&] { box.filter(0.0f, paperRules()); }), "nothing thrown");
  box = good;
  box.clustering.clusters = -1;
  EXPECT_NE(test::invalidArgumentOf([&] { box.filter(0.0f, paperRules()); }), "nothing thrown");
}

TEST(ClusterFilter, OptionsOutOfRangeAreNamed) {
  const auto message = [](auto change) {
    ClusterFilterOptions options = paperRules();
    change(options);
    return test::invalidArgumentOf([&] { Box().filter(0.0f, options); });
  };
  using Options = ClusterFilterOptions;
  EXPECT_EQ(message([](Options& o) { o.min_cluster_size = 0; }),
            "ClusterFilterOptions::min_cluster_size is 0.000000; expected a count >= 1");
  EXPECT_EQ(
      message([](Options& o) { o.min_strongest_distance = -0.5f; }),
      "ClusterFilterOptions::min_strongest_distance is -0.500000; expected a value >= 0 (px)");
  EXPECT_EQ(message([](Options& o) { o.screening_ratio = kNaN; }),
            "ClusterFilterOptions::screening_ratio is nan; expected a value >= 0");
  EXPECT_EQ(message([](Options& o) { o.screening_floor = -1.0f; }),
            "ClusterFilterOptions::screening_floor is -1.000000; expected a value >= 0 (px)");
  EXPECT_EQ(message([](Options&) {}), "nothing thrown");
}

TEST(ClusterFilter, VerdictsHaveNames) {
  EXPECT_STREQ(toString(V::kStatic), "static");
  EXPECT_STREQ(toString(V::kStrongest), "strongest");
  EXPECT_STREQ(toString(V::kScreened), "screened");
  EXPECT_STREQ(toString(V::kDepthNeighbour), "depth neighbour");
}

}  // namespace
}  // namespace hmcdyn

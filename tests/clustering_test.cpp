// SPDX-License-Identifier: BSD-3-Clause
#include <string>
#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include <hmcdyn/steps/clustering.hpp>

#include "constants.hpp"
#include "invalid_argument.hpp"

namespace hmcdyn {
namespace {

using test::kInfinity;

ClusteringOptions options(float epsilon, int min_points, float order = 2.0f) {
  ClusteringOptions result;
  result.depth_scale = 1.0f;
  result.distance_scale = 1.0f;
  result.epsilon = epsilon;
  result.min_points = min_points;
  result.order = order;
  return result;
}

using Points = std::vector<std::pair<float, float>>;

Eigen::MatrixXf matrixOf(const Points& points) {
  Eigen::MatrixXf matrix(2, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    matrix.col(static_cast<Eigen::Index>(i)) << points[i].first, points[i].second;
  }
  return matrix;
}

/// Points on a line.
Clustering cluster1d(const std::vector<float>& x, const ClusteringOptions& with) {
  Eigen::MatrixXf matrix(1, static_cast<Eigen::Index>(x.size()));
  for (std::size_t i = 0; i < x.size(); ++i) {
    matrix(0, static_cast<Eigen::Index>(i)) = x[i];
  }
  return densityClusters(matrix, with);
}

// The example on paper; epsilon = 1, MinPoints = 4, points a to m:
//
//     y
//   1.0 |    b               h
//   0.5 |
//   0.0 | a  c  d   e   g    i    j     k  l
//  -0.5 |
//  -1.0 |    f               m
//       +------------------------------------
//   x:    0  1  2  2.875  4.75 5.75     9  9.5
//                      3.75
//
// c at (1, 0) sees a, b, d, f at exactly 1 and itself: 5, a core point. i at (4.75, 0) sees g, h,
// j, m at exactly 1 and itself: a core point. d sees c, e (0.875) and itself: 3, no core point, nor
// is g. e sees d and g, neither of them a core point: noise. k and l see each other only: noise.
TEST(Clustering, TheExampleOnPaper) {
  const Points points{{0.0f, 0.0f},  {1.0f, 1.0f},  {1.0f, 0.0f},  {2.0f, 0.0f},  {2.875f, 0.0f},
                      {1.0f, -1.0f}, {3.75f, 0.0f}, {4.75f, 1.0f}, {4.75f, 0.0f}, {5.75f, 0.0f},
                      {9.0f, 0.0f},  {9.5f, 0.0f},  {4.75f, -1.0f}};
  const Clustering result = densityClusters(matrixOf(points), options(1.0f, 4));
  //                                        a  b  c  d   e  f  g  h  i  j   k   l  m
  EXPECT_EQ(result.label, (std::vector<int>{0, 0, 0, 0, -1, 0, 1, 1, 1, 1, -1, -1, 1}));
  EXPECT_EQ(result.is_core, (std::vector<std::uint8_t>{0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0}));
  EXPECT_EQ(result.clusters, 2);
}

// Two clusters on a line, and a border point b between them (epsilon 1, MinPoints 4):
//
//   0   .25  .5  .75        b        2.25 2.5 2.75  3
//
// From b = 1.5 both nearest core points are 0.75 away. b sees .5 and .75, 2.25 and 2.5, and itself:
// that would make it a core point, so MinPoints is 6 and each side gets 6 points.
class BorderPoint : public ::testing::Test {
 protected:
  static std::vector<float> lineWith(float border) {
    return {0.0f,   0.125f, 0.25f,  0.375f, 0.5f,   0.75f,  // 0-5
            border,                                         // 6
            2.25f,  2.5f,   2.625f, 2.75f,  2.875f, 3.0f};  // 7-12
  }
};

TEST_F(BorderPoint, GoesToItsNearestCorePoint) {
  const ClusteringOptions with = options(1.0f, 6);
  const Clustering low = cluster1d(lineWith(1.45f), with);
  ASSERT_EQ(low.clusters, 2);
  EXPECT_EQ(low.is_core[6], 0);
  EXPECT_EQ(low.label[6], 0);
  EXPECT_EQ(cluster1d(lineWith(1.55f), with).label[6], 1);
}

TEST_F(BorderPoint, GoesToTheSmallerCorePointAtEqualDistance) {
  const ClusteringOptions with = options(1.0f, 6);
  const Clustering result = cluster1d(lineWith(1.5f), with);
  ASSERT_EQ(result.clusters, 2);
  EXPECT_EQ(result.is_core[5], 1);
  EXPECT_EQ(result.is_core[6], 0);
  EXPECT_EQ(result.is_core[7], 1);
  EXPECT_EQ(result.label[6], 0);

  // Whichever comes first in the input.
  std::vector<float> reversed = lineWith(1.5f);
  std::reverse(reversed.begin(), reversed.end());
  EXPECT_EQ(cluster1d(reversed, with).label[6], 0);
}

TEST_F(BorderPoint, DoesNotJoinTheClustersItTouches) {
  const Clustering result = cluster1d(lineWith(1.5f), options(1.0f, 6));
  EXPECT_EQ(result.label[0], 0);
  EXPECT_EQ(result.label[12], 1);
}

TEST(Clustering, MinPointsCountsThePointItself) {
  // Given two neighbours: each has a neighbourhood of two.
  EXPECT_EQ(cluster1d({0.0f, 1.0f}, options(1.0f, 2)).clusters, 1);
  EXPECT_EQ(cluster1d({0.0f, 1.0f}, options(1.0f, 3)).clusters, 0);
  // A single point is its own neighbourhood.
  EXPECT_EQ(cluster1d({5.0f}, options(1.0f, 1)).label, std::vector<int>{0});
  EXPECT_EQ(cluster1d({5.0f}, options(1.0f, 2)).label, std::vector<int>{kNoise});
}

TEST(Clustering, TheRadiusIsInclusive) {
  EXPECT_EQ(cluster1d({0.0f, 1.0f}, options(1.0f, 2)).clusters, 1);
  EXPECT_EQ(cluster1d({0.0f, std::nextafter(1.0f, 2.0f)}, options(1.0f, 2)).clusters, 0);
  // 3-4-5.
  EXPECT_EQ(densityClusters(matrixOf({{0, 0}, {3, 4}}), options(5.0f, 2)).clusters, 1);
  EXPECT_EQ(densityClusters(matrixOf({{0, 0}, {3, 4}}), options(4.999f, 2)).clusters, 0);
}

TEST(Clustering, TheOrderShapesTheNeighbourhood) {
  // Distance of (3, 4): 7 for p = 1, 5 for p = 2, 91^(1/3) = 4.498 for p = 3, 4 for p = infinity.
  const Eigen::MatrixXf pair = matrixOf({{0, 0}, {3, 4}});
  const auto joined = [&](float order, float epsilon) {
    return densityClusters(pair, options(epsilon, 2, order)).clusters == 1;
  };
  EXPECT_TRUE(joined(1.0f, 7.0f));
  EXPECT_FALSE(joined(1.0f, 6.99f));
  EXPECT_TRUE(joined(2.0f, 5.0f));
  EXPECT_FALSE(joined(2.0f, 4.99f));
  EXPECT_TRUE(joined(3.0f, 4.4980f));
  EXPECT_FALSE(joined(3.0f, 4.4979f));
  EXPECT_TRUE(joined(kInfinity, 4.0f));
  EXPECT_FALSE(joined(kInfinity, 3.99f));
}

TEST(Clustering, LargeOrdersNeitherUnderflowNorOverflow) {
  // Along one axis the distance is |x - y| for every order. Powers of small or large differences
  // leave the range of float, and a ball of the Euclidean distance alone would let 1.3 radii in.
  for (const float order : {1.5f, 8.0f, 50.0f, 100.0f}) {
    for (const float epsilon : {1e-3f, 0.15f, 1.0f, 40.0f}) {
      const auto joined = [&](float radii) {
        return densityClusters(matrixOf({{0, 0}, {radii * epsilon, 0}}), options(epsilon, 2, order))
                   .clusters == 1;
      };
      EXPECT_TRUE(joined(0.5f)) << "order " << order << " epsilon " << epsilon;
      EXPECT_TRUE(joined(1.0f)) << "order " << order << " epsilon " << epsilon;
      EXPECT_FALSE(joined(1.3f)) << "order " << order << " epsilon " << epsilon;
    }
  }
}

TEST(Clustering, EqualPointsShareACluster) {
  for (const int n : {4, 5, 30, 200}) {
    const Eigen::MatrixXf points = Eigen::MatrixXf::Constant(2, n, 1.5f);
    const Clustering result = densityClusters(points, options(0.25f, 4));
    EXPECT_EQ(result.clusters, 1);
    EXPECT_EQ(result.label, std::vector<int>(static_cast<std::size_t>(n), 0));
    EXPECT_EQ(result.is_core, std::vector<std::uint8_t>(static_cast<std::size_t>(n), 1));
  }
}

TEST(Clustering, LonelyPointsAreNoise) {
  const Clustering result = cluster1d({0.0f, 10.0f, 20.0f, 30.0f}, options(1.0f, 2));
  EXPECT_EQ(result.clusters, 0);
  EXPECT_EQ(result.label, std::vector<int>(4, kNoise));
  EXPECT_EQ(result.is_core, std::vector<std::uint8_t>(4, 0));
}

TEST(Clustering, NothingGivesNothing) {
  EXPECT_EQ(densityClusters(Eigen::MatrixXf(2, 0), options(1.0f, 2)).clusters, 0);
  EXPECT_TRUE(densityClusters(Eigen::MatrixXf(), options(1.0f, 2)).label.empty());
  EXPECT_TRUE(clusterBox({}, {}, options(1.0f, 2)).label.empty());
  EXPECT_TRUE(clusterBox({}, {}, options(1.0f, 2, 1.5f)).label.empty());  // another backend
}

TEST(Clustering, PointsThatAreNotFiniteAreNoiseAndNobodysNeighbour) {
  for (const float bad : {kNaN, kInfinity, -kInfinity}) {
    const Clustering result = cluster1d({0.0f, bad, 0.5f, bad, bad}, options(1.0f, 2));
    EXPECT_EQ(result.label, (std::vector<int>{0, kNoise, 0, kNoise, kNoise}));
    EXPECT_EQ(result.is_core, (std::vector<std::uint8_t>{1, 0, 1, 0, 0}));
    EXPECT_EQ(cluster1d({bad, bad, bad}, options(1.0f, 1)).clusters, 0);
  }
}

TEST(Clustering, FarAwayPointsDoNoHarm) {
  const Clustering result = cluster1d({0.0f, 3e38f, 0.5f, -3e38f, 1e30f, 1e20f}, options(1.0f, 2));
  EXPECT_EQ(result.label, (std::vector<int>{0, kNoise, 0, kNoise, kNoise, kNoise}));
}

TEST(Clustering, PointsWithoutCoordinatesAreRefused) {
  EXPECT_EQ(
      test::invalidArgumentOf([] { densityClusters(Eigen::MatrixXf(0, 20), options(1.0f, 2)); }),
      "densityClusters: 20 points of 0 coordinates; expected at least 1");
}

TEST(ClusterBox, WeighsDepthAndDistance) {
  // Given points 0.1 m and 2 px apart: 1/m * 0.1 and 0.05/px * 2 are 0.1 each, 0.1414 together.
  ClusteringOptions with = options(0.15f, 2);
  with.distance_scale = 0.05f;
  const std::vector<float> depth{2.0f, 2.1f}, distance{1.0f, 3.0f};
  EXPECT_EQ(clusterBox(depth, distance, with).clusters, 1);
  with.epsilon = 0.14f;
  EXPECT_EQ(clusterBox(depth, distance, with).clusters, 0);
  with.depth_scale = 0.5f;  // 0.05 and 0.1: 0.1118
  EXPECT_EQ(clusterBox(depth, distance, with).clusters, 1);
  with.distance_scale = 0.1f;  // 0.05 and 0.2
  EXPECT_EQ(clusterBox(depth, distance, with).clusters, 0);
}

TEST(ClusterBox, NumbersFromTheNearest) {
  const std::vector<float> depth{5.0f, 2.0f, 5.0f, 2.0f}, distance{0.0f, 9.0f, 0.0f, 9.0f};
  EXPECT_EQ(clusterBox(depth, distance, options(0.5f, 2)).label, (std::vector<int>{1, 0, 1, 0}));
}

TEST(ClusterBox, PointsWithoutDepthOrDistanceAreNoise) {
  const std::vector<float> depth{2.0f, 0.0f, 2.0f, -2.0f, 2.0f, kNaN, kInfinity, 2.0f};
  const std::vector<float> distance{1.0f, 1.0f, 1.0f, 1.0f, kNaN, 1.0f, 1.0f, kInfinity};
  EXPECT_EQ(clusterBox(depth, distance, options(0.5f, 1)).label,
            (std::vector<int>{0, kNoise, 0, kNoise, kNoise, kNoise, kNoise, kNoise}));
}

TEST(ClusterBox, UnequalSizesAreRefused) {
  const std::vector<float> two(2, 1.0f), three(3, 1.0f);
  EXPECT_EQ(test::invalidArgumentOf([&] { clusterBox(two, three, options(1.0f, 2)); }),
            "clusterBox: 2 depths, but 3 distances; expected equal sizes");
}

TEST(Clustering, OptionsOutOfRangeAreNamed) {
  const auto message = [](auto change) {
    ClusteringOptions with = options(1.0f, 4);
    change(with);
    return test::invalidArgumentOf([&] { densityClusters(Eigen::MatrixXf(2, 0), with); });
  };
  using Options = ClusteringOptions;
  EXPECT_EQ(message([](Options& o) { o.epsilon = 0.0f; }),
            "ClusteringOptions::epsilon is 0.000000; expected a value in [1e-15, 1e15]");
  EXPECT_EQ(message([](Options& o) { o.epsilon = kNaN; }),
            "ClusteringOptions::epsilon is nan; expected a value in [1e-15, 1e15]");
  EXPECT_EQ(message([](Options& o) { o.min_points = 0; }),
            "ClusteringOptions::min_points is 0.000000; expected a count >= 1");
  EXPECT_EQ(message([](Options& o) { o.order = 0.5f; }),
            "ClusteringOptions::order is 0.500000; expected a value in [1, 100], or infinity");
  EXPECT_EQ(message([](Options& o) { o.order = 101.0f; }),
            "ClusteringOptions::order is 101.000000; expected a value in [1, 100], or infinity");
  EXPECT_EQ(message([](Options& o) { o.order = -kInfinity; }),
            "ClusteringOptions::order is -inf; expected a value in [1, 100], or infinity");
  EXPECT_EQ(message([](Options& o) { o.depth_scale = -1.0f; }),
            "ClusteringOptions::depth_scale is -1.000000; expected a finite value > 0 (1/m)");
  EXPECT_EQ(message([](Options& o) { o.distance_scale = kInfinity; }),
            "ClusteringOptions::distance_scale is inf; expected a finite value > 0 (1/px)");
  EXPECT_EQ(message([](Options&) {}), "nothing thrown");
  EXPECT_EQ(message([](Options& o) { o.order = kInfinity; }), "nothing thrown");
}

}  // namespace
}  // namespace hmcdyn

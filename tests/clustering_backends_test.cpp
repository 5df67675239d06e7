// SPDX-License-Identifier: BSD-3-Clause
// Every clustering backend gives what the textbook gives, whichever is faster.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include <hmcdyn/steps/clustering.hpp>

#include "brute_force_dbscan.hpp"
#include "random.hpp"

namespace hmcdyn {
namespace {

using test::Random;

struct PlanarInput {
  Eigen::Matrix2Xf points;
  float epsilon = 1.0f;
  int min_points = 5;

  std::string describe() const {
    return std::to_string(points.cols()) + " points, epsilon " + std::to_string(epsilon) +
           ", min_points " + std::to_string(min_points);
  }
};

/// Blobs, a line and scattered points, on a lattice of 1/8 (distances tie exactly all the time) or
/// anywhere.
PlanarInput makePlanarInput(Random& random, bool on_lattice) {
  PlanarInput input;
  const int n = random.chance(0.03) ? random.integer(200, 450) : random.integer(0, 110);
  input.epsilon =
      on_lattice ? static_cast<float>(random.integer(1, 8)) / 8.0f : random.uniformFloat(0.1, 1.0);
  input.min_points = random.integer(1, 8);
  input.points.resize(2, n);
  const double extent = random.uniform(0.5, 6.0);
  const double spread = random.uniform(0.1, 1.0);
  for (Eigen::Index i = 0; i < n; ++i) {
    Eigen::Vector2d point(random.uniform(-extent, extent), random.uniform(-extent, extent));
    const double kind = random.uniform(0.0, 1.0);
    if (kind < 0.35) {
      point = Eigen::Vector2d(-extent / 2 + random.normal(spread), random.normal(spread));
    } else if (kind < 0.6) {
      point = Eigen::Vector2d(extent / 2 + random.normal(spread), random.normal(spread / 4));
    } else if (kind < 0.75) {
      point.y() = -extent;
    }
    input.points.col(i) = point.cast<float>();
    if (on_lattice) {
      input.points.col(i) = (input.points.col(i) * 8.0f).array().round() / 8.0f;
    }
    if (random.chance(0.02)) {
      input.points(random.integer(0, 1), i) =
          random.chance(0.5) ? kNaN : std::numeric_limits<float>::infinity();
    }
  }
  return input;
}

Clustering sized(std::size_t n) {
  Clustering result;
  result.label.assign(n, 77);
  result.is_core.assign(n, 77);
  return result;
}

detail::PlanarPoints planar(const Eigen::Matrix2Xf& points) {
  detail::PlanarPoints result;
  result.resize(static_cast<std::size_t>(points.cols()));
  for (std::size_t i = 0; i < result.size; ++i) {
    const Eigen::Vector2f point = points.col(static_cast<Eigen::Index>(i));
    result.x[i] = point.allFinite() ? point.x() : kNaN;
    result.y[i] = point.allFinite() ? point.y() : kNaN;
  }
  return result;
}

Clustering byBitSets(const PlanarInput& input) {
  Clustering result = sized(static_cast<std::size_t>(input.points.cols()));
  detail::BitSetWorkspace workspace;
  detail::clusterByBitSets(planar(input.points), input.epsilon, input.min_points, workspace,
                           result);
  return result;
}

Clustering byGrid(const PlanarInput& input, detail::GridWorkspace& workspace) {
  Clustering result = sized(static_cast<std::size_t>(input.points.cols()));
  const detail::PlanarPoints points = planar(input.points);
  const detail::GridLayout layout = detail::layOutGrid(points, input.epsilon);
  if (layout.rows > 0) {
    detail::clusterByGrid(points, layout, input.epsilon, input.min_points, workspace, result);
  } else {  // no point at all
    std::fill(result.label.begin(), result.label.end(), kNoise);
    std::fill(result.is_core.begin(), result.is_core.end(), std::uint8_t{0});
  }
  return result;
}

Clustering byKdTree(const PlanarInput& input) {
  Clustering result = sized(static_cast<std::size_t>(input.points.cols()));
  detail::clusterByKdTree(input.points, detail::MinkowskiBall(2.0f, input.epsilon),
                          input.min_points, result);
  return result;
}

void expectEqual(const Clustering& actual, const Clustering& expected, const std::string& what) {
  ASSERT_EQ(actual.label, expected.label) << what;
  ASSERT_EQ(actual.is_core, expected.is_core) << what;
  ASSERT_EQ(actual.clusters, expected.clusters) << what;
}

class ClusteringBackends : public ::testing::TestWithParam<bool> {};

TEST_P(ClusteringBackends, AgreeWithTheTextbook) {
  Random random(GetParam() ? 51 : 52);
  detail::GridWorkspace reused;
  int borders = 0;
  int several = 0;
  for (int trial = 0; trial < 1500; ++trial) {
    const PlanarInput input = makePlanarInput(random, GetParam());
    const test::BruteForceClusters textbook =
        test::BruteForceDbscan(input.points, input.epsilon, input.min_points, 2.0).result();
    Clustering expected;
    expected.label = textbook.label;
    expected.is_core.assign(textbook.is_core.begin(), textbook.is_core.end());
    expected.clusters = textbook.clusters;
    const std::string what = "trial " + std::to_string(trial) + ": " + input.describe();
    if (input.points.cols() <= static_cast<Eigen::Index>(detail::kBitSetCapacity)) {
      ASSERT_NO_FATAL_FAILURE(expectEqual(byBitSets(input), expected, "bit sets, " + what));
    }
    ASSERT_NO_FATAL_FAILURE(expectEqual(byGrid(input, reused), expected, "grid, " + what));
    ASSERT_NO_FATAL_FAILURE(expectEqual(byKdTree(input), expected, "kd-tree, " + what));
    for (std::size_t i = 0; i < expected.label.size(); ++i) {
      borders += expected.is_core[i] == 0 && expected.label[i] != kNoise ? 1 : 0;
    }
    several += expected.clusters > 1 ? 1 : 0;
  }
  // The inputs are worth their name.
  EXPECT_GT(borders, 3000);
  EXPECT_GT(several, 500);
}

INSTANTIATE_TEST_SUITE_P(Coordinates, ClusteringBackends, ::testing::Bool(),
                         [](const ::testing::TestParamInfo<bool>& on_lattice) {
                           return on_lattice.param ? "Eighths" : "Continuous";
                         });

/// What densityClusters gives, which picks the backend.
Clustering dispatched(const PlanarInput& input) {
  ClusteringOptions options;
  options.epsilon = input.epsilon;
  options.min_points = input.min_points;
  options.order = 2.0f;
  return densityClusters(input.points, options);
}

TEST(ClusteringDispatch, AllPointsEqual) {
  for (const int n : {1, 64, 65, 256, 257, 5000}) {
    const PlanarInput input{Eigen::Matrix2Xf::Constant(2, n, 0.7f), 0.1f, 1};
    const Clustering result = dispatched(input);
    EXPECT_EQ(result.clusters, 1) << n;
    EXPECT_EQ(result.label, std::vector<int>(static_cast<std::size_t>(n), 0)) << n;
    EXPECT_EQ(result.is_core, std::vector<std::uint8_t>(static_cast<std::size_t>(n), 1)) << n;
  }
}

TEST(ClusteringDispatch, AllNoise) {
  for (const int n : {1, 64, 65, 256, 257, 5000}) {
    // A diagonal with steps above the radius.
    PlanarInput input{Eigen::Matrix2Xf(2, n), 0.25f, 2};
    for (int i = 0; i < n; ++i) {
      input.points.col(i).setConstant(0.2f * static_cast<float>(i));
    }
    const Clustering result = dispatched(input);
    EXPECT_EQ(result.clusters, 0) << n;
    EXPECT_EQ(result.label, std::vector<int>(static_cast<std::size_t>(n), kNoise)) << n;
    EXPECT_EQ(result.is_core, std::vector<std::uint8_t>(static_cast<std::size_t>(n), 0)) << n;
  }
}

TEST(ClusteringDispatch, EveryPointItsOwnCluster) {
  for (const int n : {64, 256, 257, 3000}) {
    // Descending: the last point is the smallest.
    PlanarInput input{Eigen::Matrix2Xf(2, n), 0.25f, 1};
    std::vector<int> expected;
    for (int i = 0; i < n; ++i) {
      input.points.col(i) << static_cast<float>(n - i), 0.0f;
      expected.push_back(n - 1 - i);
    }
    EXPECT_EQ(dispatched(input).label, expected) << n;
  }
}

TEST(ClusteringDispatch, OneLongSnake) {
  for (const int n : {64, 256, 257, 20000}) {
    // Steps of 1/8 along a line, radius 1/8: the ends are border points under MinPoints 3.
    PlanarInput input{Eigen::Matrix2Xf::Zero(2, n), 0.125f, 3};
    for (int i = 0; i < n; ++i) {
      input.points(1, i) = static_cast<float>(i) / 8.0f;
    }
    const Clustering result = dispatched(input);
    std::vector<std::uint8_t> core;
    for (int i = 0; i < n; ++i) {
      core.push_back(i == 0 || i == n - 1 ? 0 : 1);
    }
    EXPECT_EQ(result.label, std::vector<int>(static_cast<std::size_t>(n), 0)) << n;
    EXPECT_EQ(result.is_core, core) << n;
  }
}

TEST(ClusteringDispatch, NothingFinite) {
  for (const int n : {1, 64, 257, 1000}) {
    const Clustering result = dispatched({Eigen::Matrix2Xf::Constant(2, n, kNaN), 0.1f, 1});
    EXPECT_EQ(result.clusters, 0) << n;
    EXPECT_EQ(result.label, std::vector<int>(static_cast<std::size_t>(n), kNoise)) << n;
    EXPECT_EQ(result.is_core, std::vector<std::uint8_t>(static_cast<std::size_t>(n), 0)) << n;
  }
}

TEST(ClusteringDispatch, WidelyScatteredPointsNeedNoGrid) {
  // Given two groups and points that lie too far away for any grid
  PlanarInput input{Eigen::Matrix2Xf(2, 600), 1.0f, 4};
  for (int i = 0; i < 600; ++i) {
    const auto value = static_cast<float>(i);
    input.points.col(i) << (i < 500 ? static_cast<float>(i % 2) * 50.0f : 1e30f * (value - 450.0f)),
        0.001f * value;
  }
  EXPECT_EQ(detail::layOutGrid(planar(input.points), 1.0f).rows, 0U);
  const Clustering result = dispatched(input);
  EXPECT_EQ(result.clusters, 2);
  for (std::size_t i = 0; i < 600; ++i) {
    EXPECT_EQ(result.label[i], i < 500 ? static_cast<int>(i % 2) : kNoise) << i;
  }
}

TEST(ClusteringDispatch, AReusedWorkspaceGivesWhatAFreshOneGives) {
  Random random(53);
  ClusteringWorkspace workspace;
  ClusteringOptions options;
  options.order = 2.0f;
  for (int trial = 0; trial < 300; ++trial) {
    const PlanarInput input = makePlanarInput(random, trial % 2 == 0);
    options.epsilon = input.epsilon;
    options.min_points = input.min_points;
    ASSERT_NO_FATAL_FAILURE(expectEqual(densityClusters(input.points, options, workspace),
                                        densityClusters(input.points, options),
                                        "trial " + std::to_string(trial)));
  }
}

TEST(ClusteringDispatch, BoxesAndColumnsAgree) {
  Random random(54);
  ClusteringWorkspace workspace;
  for (int trial = 0; trial < 200; ++trial) {
    const int n = random.integer(0, 400);
    ClusteringOptions options;
    options.depth_scale = random.uniformFloat(0.5, 2.0);
    options.distance_scale = random.uniformFloat(0.02, 0.2);
    options.order = trial % 4 == 0 ? 1.0f : 2.0f;
    std::vector<float> depth, distance;
    Eigen::Matrix2Xf columns(2, n);
    for (int i = 0; i < n; ++i) {
      depth.push_back(random.chance(0.1) ? 0.0f : random.uniformFloat(1.0, 3.0));
      distance.push_back(random.chance(0.1) ? kNaN : random.uniformFloat(0.0, 5.0));
      columns.col(i) << (depth.back() > 0.0f ? options.depth_scale * depth.back() : kNaN),
          options.distance_scale * distance.back();
    }
    ASSERT_NO_FATAL_FAILURE(expectEqual(clusterBox(depth, distance, options, workspace),
                                        densityClusters(columns, options),
                                        "trial " + std::to_string(trial)));
  }
}

TEST(NeighbourTest, RoundsEachOperationInEveryBuild) {
  // Given differences whose distance is the radius up to rounding, where a fused multiply-add would
  // decide otherwise now and then
  Random random(55);
  int inside = 0;
  int fused_differs = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const std::array<float, 2> origin{0.0f, 0.0f};
    const std::array<float, 2> point{random.uniformFloat(0.1, 1.0), random.uniformFloat(0.1, 1.0)};
    const float radius = std::sqrt(point[0] * point[0] + point[1] * point[1]);
    // volatile: each result goes through memory, rounded
    const volatile float xx = point[0] * point[0];
    const volatile float yy = point[1] * point[1];
    const volatile float sum = xx + yy;
    const volatile float limit = radius * radius;
    const bool expected = sum <= limit;
    EXPECT_EQ(detail::Disc(radius).contains(point[0], point[1]), expected);
    const detail::MinkowskiBall ball(2.0f, radius);
    EXPECT_EQ(ball.contains(ball.power(origin.data(), point.data(), 2)), expected);
    inside += expected ? 1 : 0;
    fused_differs += (std::fma(point[0], point[0], yy) <= limit) != expected ? 1 : 0;
  }
  // The inputs are worth their name.
  EXPECT_GT(inside, 5000);
  EXPECT_GT(fused_differs, 1000);
}

TEST(NeighbourTest, BlocksAgreeWithPoints) {
  Random random(56);
  for (int trial = 0; trial < 500; ++trial) {
    std::array<float, detail::kBlock> x{}, y{};
    for (std::size_t i = 0; i < detail::kBlock; ++i) {
      // Multiples of 1/8 around, with many at the radius of 5/8, or no point at all
      const bool none = random.chance(0.1);
      x[i] = none ? kNaN : static_cast<float>(random.integer(-6, 6)) / 8.0f;
      y[i] = none ? kNaN : static_cast<float>(random.integer(-6, 6)) / 8.0f;
    }
    std::uint32_t expected = 0;
    for (std::size_t i = 0; i < detail::kBlock; ++i) {
      const bool near = x[i] * x[i] + y[i] * y[i] <= 25.0f / 64.0f;
      expected |= near ? std::uint32_t{1} << i : 0;
    }
    const detail::Disc disc(5.0f / 8.0f);
    EXPECT_EQ(disc.neighboursInBlock(x.data(), y.data(), 0.0f, 0.0f), expected);
    EXPECT_EQ(disc.neighboursInBlockPortably(x.data(), y.data(), 0.0f, 0.0f), expected);
  }
}

TEST(BitOperations, Transpose) {
  Random random(57);
  std::array<std::uint32_t, 32> from{}, to{};
  for (std::uint32_t& row : from) {
    row = static_cast<std::uint32_t>(random.uniform(0.0, 4294967296.0));
  }
  detail::transpose32(from.data(), to.data());
  for (std::size_t i = 0; i < 32; ++i) {
    for (std::size_t j = 0; j < 32; ++j) {
      EXPECT_EQ((to[j] >> i) & 1U, (from[i] >> j) & 1U) << i << " " << j;
    }
  }
}

TEST(BitOperations, CountAndFind) {
  EXPECT_EQ(detail::countOnes(0), 0U);
  EXPECT_EQ(detail::countOnes(~std::uint64_t{0}), 64U);
  EXPECT_EQ(detail::countOnes(0x8000000000000001U), 2U);
  for (std::uint32_t i = 0; i < 64; ++i) {
    EXPECT_EQ(detail::lowestOne(std::uint64_t{1} << i), i);
    EXPECT_EQ(detail::lowestOne(~std::uint64_t{0} << i), i);
    EXPECT_EQ(detail::highestOne(std::uint64_t{1} << i), i);
    EXPECT_EQ(detail::highestOne(~std::uint64_t{0} >> i), 63 - i);
  }
}

}  // namespace
}  // namespace hmcdyn

// SPDX-License-Identifier: BSD-3-Clause
// Properties of the density clustering over random inputs, and its agreement with the textbook's.
#include <cmath>
#include <cstdint>
#include <sstream>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <gtest/gtest.h>

#include <hmcdyn/steps/clustering.hpp>

#include "brute_force_dbscan.hpp"
#include "constants.hpp"
#include "random.hpp"

namespace hmcdyn {
namespace {

using test::kInfinity;
using test::Random;

constexpr float kOrders[] = {1.0f, 2.0f, 3.0f, kInfinity};

struct Input {
  Eigen::MatrixXf points;
  ClusteringOptions options;

  std::string describe() const {
    std::ostringstream text;
    text << points.cols() << " points of " << points.rows() << " coordinates, epsilon "
         << options.epsilon << ", min_points " << options.min_points << ", order " << options.order;
    return text.str();
  }
};

enum class Coordinates : std::uint8_t {
  kEighths,     ///< Multiples of 1/8: distances tie exactly all the time.
  kContinuous,  ///< Any float: ties are improbable.
};

Input makeInput(Random& random, Coordinates coordinates) {
  Input input;
  const int dimensions = random.integer(1, 4);
  const int n = random.integer(0, 120);
  input.options.depth_scale = 1.0f;
  input.options.distance_scale = 1.0f;
  input.options.order = kOrders[random.integer(0, 3)];
  input.options.min_points = random.integer(1, 7);
  // Sides and radii that leave noise, borders and several clusters in every dimension.
  const int side = random.integer(4, 40 / dimensions + 4);
  const bool ties = coordinates == Coordinates::kEighths;
  input.options.epsilon =
      ties ? static_cast<float>(random.integer(1, 8)) / 8.0f : random.uniformFloat(0.1, 1.0);
  input.points.resize(dimensions, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index k = 0; k < dimensions; ++k) {
      input.points(k, i) = ties ? static_cast<float>(random.integer(-side, side)) / 8.0f
                                : random.uniformFloat(-side / 8.0, side / 8.0);
    }
    if (random.chance(0.02)) {
      input.points(random.integer(0, dimensions - 1), i) = random.chance(0.5) ? kNaN : kInfinity;
    }
  }
  return input;
}

void expectEqual(const Clustering& actual, const Clustering& expected, const Input& input) {
  EXPECT_EQ(actual.label, expected.label) << input.describe();
  EXPECT_EQ(actual.is_core, expected.is_core) << input.describe();
  EXPECT_EQ(actual.clusters, expected.clusters) << input.describe();
}

class ClusteringProperties : public ::testing::TestWithParam<Coordinates> {};

TEST_P(ClusteringProperties, AgreesWithTheTextbook) {
  Random random(2024);
  int borders = 0;
  int several = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const Input input = makeInput(random, GetParam());
    const Clustering actual = densityClusters(input.points, input.options);
    const test::BruteForceClusters expected =
        test::BruteForceDbscan(input.points, input.options.epsilon, input.options.min_points,
                               input.options.order)
            .result();
    ASSERT_EQ(actual.label, expected.label) << "trial " << trial << ": " << input.describe();
    ASSERT_EQ(actual.clusters, expected.clusters) << "trial " << trial;
    for (std::size_t i = 0; i < expected.is_core.size(); ++i) {
      ASSERT_EQ(actual.is_core[i] != 0, expected.is_core[i]) << "trial " << trial << " point " << i;
      borders += !expected.is_core[i] && expected.label[i] >= 0 ? 1 : 0;
    }
    several += expected.clusters > 1 ? 1 : 0;
  }
  // The inputs are worth their name.
  EXPECT_GT(borders, 1000);
  EXPECT_GT(several, 300);
}

// Many points share a cell in which all are neighbours, which spares the search.
TEST_P(ClusteringProperties, AgreesWithTheTextbookWherePointsAreDense) {
  Random random(77);
  int borders = 0;
  int several = 0;
  int worth_it = 0;
  for (int trial = 0; trial < 300; ++trial) {
    Input input;
    const int dimensions = random.integer(1, 3);
    const int n = random.integer(50, 250);
    input.options.order = kOrders[random.integer(0, 3)];
    input.options.min_points = random.integer(1, 40);
    input.options.epsilon = 1.0f;
    input.points.resize(dimensions, n);
    const int clumps = random.integer(1, 6);
    Eigen::MatrixXf centres(dimensions, clumps);
    for (Eigen::Index c = 0; c < centres.size(); ++c) {
      centres(c) = random.uniformFloat(-2.0, 2.0);
    }
    const float spread = random.uniformFloat(0.1, 0.6);
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index k = 0; k < dimensions; ++k) {
        const float value = centres(k, i % clumps) + spread * random.uniformFloat(-1.0, 1.0);
        input.points(k, i) =
            GetParam() == Coordinates::kEighths ? std::round(64.0f * value) / 64.0f : value;
      }
    }
    const detail::MinkowskiBall ball(input.options.order, input.options.epsilon);
    worth_it += detail::NeighbourCells(input.points, ball).areWorthIt() ? 1 : 0;
    const Clustering actual = densityClusters(input.points, input.options);
    const test::BruteForceClusters expected =
        test::BruteForceDbscan(input.points, input.options.epsilon, input.options.min_points,
                               input.options.order)
            .result();
    ASSERT_EQ(actual.label, expected.label) << "trial " << trial << ": " << input.describe();
    for (std::size_t i = 0; i < expected.is_core.size(); ++i) {
      ASSERT_EQ(actual.is_core[i] != 0, expected.is_core[i]) << "trial " << trial << " point " << i;
      borders += !expected.is_core[i] && expected.label[i] >= 0 ? 1 : 0;
    }
    several += expected.clusters > 1 ? 1 : 0;
  }
  EXPECT_GT(borders, 500);
  EXPECT_GT(several, 50);
  EXPECT_GT(worth_it, 200);
}

TEST_P(ClusteringProperties, LabelsFollowThePointsInAnyOrder) {
  Random random(31);
  for (int trial = 0; trial < 200; ++trial) {
    const Input input = makeInput(random, GetParam());
    const Clustering before = densityClusters(input.points, input.options);
    const std::vector<std::size_t> order = random.permutation(before.label.size());
    Input shuffled = input;
    Clustering expected = before;
    for (std::size_t i = 0; i < order.size(); ++i) {
      shuffled.points.col(static_cast<Eigen::Index>(i)) =
          input.points.col(static_cast<Eigen::Index>(order[i]));
      expected.label[i] = before.label[order[i]];
      expected.is_core[i] = before.is_core[order[i]];
    }
    expectEqual(densityClusters(shuffled.points, shuffled.options), expected, shuffled);
  }
}

TEST_P(ClusteringProperties, ScalingPointsAndRadiusChangesNothing) {
  Random random(32);
  for (int trial = 0; trial < 200; ++trial) {
    const Input input = makeInput(random, GetParam());
    const Clustering expected = densityClusters(input.points, input.options);
    for (const float scale : {2.0f, 0.25f, 1024.0f}) {
      Input scaled = input;
      scaled.points *= scale;
      scaled.options.epsilon *= scale;
      expectEqual(densityClusters(scaled.points, scaled.options), expected, scaled);
    }
  }
}

TEST(ClusteringInvariance, TranslationChangesNothing) {
  Random random(33);
  for (int trial = 0; trial < 200; ++trial) {
    // Multiples of 1/8 moved by multiples of 1/8 stay exact.
    const Input input = makeInput(random, Coordinates::kEighths);
    Input moved = input;
    for (Eigen::Index k = 0; k < moved.points.rows(); ++k) {
      moved.points.row(k).array() += static_cast<float>(random.integer(-800, 800)) / 8.0f;
    }
    expectEqual(densityClusters(moved.points, moved.options),
                densityClusters(input.points, input.options), moved);
  }
}

TEST(ClusteringInvariance, AxesAreEqualInRights) {
  Random random(34);
  for (int trial = 0; trial < 200; ++trial) {
    // Reversing the axes renumbers clusters and settles ties differently; what is core stays.
    const Input input = makeInput(random, Coordinates::kEighths);
    const Clustering expected = densityClusters(input.points, input.options);
    const Clustering actual =
        densityClusters(input.points.colwise().reverse().eval(), input.options);
    EXPECT_EQ(actual.is_core, expected.is_core) << input.describe();
    EXPECT_EQ(actual.clusters, expected.clusters) << input.describe();
  }
}

INSTANTIATE_TEST_SUITE_P(Coordinates, ClusteringProperties,
                         ::testing::Values(Coordinates::kEighths, Coordinates::kContinuous),
                         [](const ::testing::TestParamInfo<Coordinates>& of) {
                           return of.param == Coordinates::kEighths ? "Eighths" : "Continuous";
                         });

}  // namespace
}  // namespace hmcdyn

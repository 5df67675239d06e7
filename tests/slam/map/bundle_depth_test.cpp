// SPDX-License-Identifier: BSD-3-Clause
// Depths that are wrong alike in all views of a point, and depths that disagree.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "map/bundle_scene.hpp"
#include "random.hpp"
#include "slam/map/bundle_adjustment.hpp"

namespace hmcdyn::slam {
namespace {

using hmcdyn::test::Random;

/// Exact pixels; each point's depths are off by an offset of its own, the same in all views.
/// @return the offsets (1/m), of standard deviation 0.01.
std::vector<double> shiftDepths(BundleProblem& problem, std::uint32_t seed) {
  Random random(seed);
  std::vector<double> offsets;
  for (std::size_t i = 0; i < problem.points.size(); ++i) {
    offsets.push_back(random.normal(0.01));
  }
  for (BundleObservation& observation : problem.observations) {
    observation.sigma = 0.1f;
    const double z = observation.depth;
    observation.depth =
        static_cast<float>(z + offsets[static_cast<std::size_t>(observation.point)] * z * z);
  }
  return offsets;
}

TEST(BundleDepth, WhatAPointsDepthsShareIsFoundAndPixelsSayWhereItIs) {
  const BundleProblem truth = test::makeBundleScene(5, 4, 200, 4, 0.0).truth;
  BundleProblem seen = truth;
  const std::vector<double> offsets = shiftDepths(seen, 6);
  const BundleSolution solution = adjustBundle(test::disturbed(seen, 7, 0.002, 0.01));
  ASSERT_EQ(solution.depth_offsets.size(), offsets.size());
  EXPECT_LT(test::largestPoseError(solution.poses, truth), 0.004);
  double square = 0.0;
  for (std::size_t i = 0; i < offsets.size(); ++i) {
    const double error = solution.depth_offsets[i] - offsets[i];
    square += error * error;
  }
  EXPECT_LT(std::sqrt(square / static_cast<double>(offsets.size())), 0.2 * 0.01);
}

TEST(BundleDepth, ACameraWithoutSystematicErrorHasNoOffsets) {
  const BundleProblem truth = test::makeBundleScene(8, 4, 60, 4, 1.0).truth;
  BundleOptions options;
  options.depth_error.systematic_quadratic = 0.0f;
  const BundleSolution solution = adjustBundle(truth, options);
  for (const double offset : solution.depth_offsets) {
    EXPECT_LT(std::abs(offset), 1e-4);
  }
}

TEST(BundleDepth, WhereOnlyTheDepthDisagreesTheObservationStays) {
  const BundleProblem truth = test::makeBundleScene(9, 4, 100, 4, 0.3).truth;
  BundleProblem seen = truth;
  seen.observations[10].depth += 0.7f;  // the other side of an edge
  const BundleSolution solution = adjustBundle(seen);
  EXPECT_EQ(solution.inlier[10], 1);
  const auto point = static_cast<std::size_t>(seen.observations[10].point);
  EXPECT_LT((solution.points[point] - truth.points[point]).norm(), 0.03);
}

TEST(BundleDepth, OffsetsOfAnotherSizeThanThePointsAreRefused) {
  BundleProblem problem = test::makeBundleScene(10, 3, 30, 3, 0.0).truth;
  problem.depth_offsets.assign(29, 0.0);
  EXPECT_THROW(adjustBundle(problem), std::invalid_argument);
}

}  // namespace
}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#include "slam/loop/rigid_ransac.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "invalid_argument.hpp"
#include "loop/place_scene.hpp"
#include "random.hpp"

namespace hmcdyn::slam {
namespace {

using hmcdyn::test::invalidArgumentOf;
using hmcdyn::test::Random;
using test::motionOf;

const PinholeCamera kRoundLens{500.0, 500.0, 320.0, 240.0};

const Eigen::Isometry3d kMotion = motionOf({0.1, -0.3, 0.2}, {0.4, -0.1, 0.25});

SightedPoint sight(const Eigen::Vector3d& point, double sigma = 1.0) {
  const Eigen::Vector2d pixel = kRoundLens.project(point);
  return {pixel.x(), pixel.y(), point.z(), sigma};
}

Eigen::Vector3d anywhere(Random& random) {
  const double x = random.uniform(-1.0, 1.0);
  const double y = random.uniform(-0.8, 0.8);
  return {x, y, random.uniform(1.5, 3.5)};
}

SightedPair exactPair(const Eigen::Vector3d& point, const Eigen::Isometry3d& to_from,
                      double sigma = 1.0) {
  return {sight(point, sigma), sight(to_from * point, sigma)};
}

std::vector<SightedPair> exactPairs(Random& random, std::size_t n,
                                    const Eigen::Isometry3d& to_from) {
  std::vector<SightedPair> pairs;
  while (pairs.size() < n) {
    pairs.push_back(exactPair(anywhere(random), to_from));
  }
  return pairs;
}

/// A pair of places that have nothing to do with each other: more than 50 px from agreeing.
SightedPair wrongPair(Random& random, const Eigen::Isometry3d& to_from) {
  while (true) {
    const Eigen::Vector3d from = anywhere(random);
    const Eigen::Vector3d to = anywhere(random);
    if ((kRoundLens.project(to_from * from) - kRoundLens.project(to)).norm() > 50.0) {
      return {sight(from), sight(to)};
    }
  }
}

double distanceOf(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return (a.matrix() - b.matrix()).norm();
}

void expectRefused(const std::vector<SightedPair>& pairs, std::size_t usable) {
  const RigidRansacResult result = rigidRansac(pairs, kRoundLens);
  EXPECT_FALSE(result.found);
  EXPECT_EQ(result.usable, usable);
  EXPECT_EQ(result.inliers, 0U);
  EXPECT_EQ(result.inlier, std::vector<std::uint8_t>(pairs.size(), 0));
  EXPECT_EQ(result.to_from.matrix(), Eigen::Matrix4d::Identity());
}

TEST(RigidRansac, RecoversTheMotionExactlyAmongSixtyPercentWrongPairs) {
  for (std::uint32_t seed = 1; seed <= 5; ++seed) {
    Random random(seed);
    std::vector<SightedPair> pairs;
    std::vector<std::uint8_t> right;
    for (int i = 0; i < 200; ++i) {
      right.push_back(i % 5 < 2 ? 1 : 0);
      pairs.push_back(right.back() != 0 ? exactPair(anywhere(random), kMotion)
                                        : wrongPair(random, kMotion));
    }
    const RigidRansacResult result = rigidRansac(pairs, kRoundLens);
    ASSERT_TRUE(result.found) << "seed " << seed;
    EXPECT_LT(distanceOf(result.to_from, kMotion), 1e-9) << "seed " << seed;
    EXPECT_EQ(result.inlier, right) << "seed " << seed;
    EXPECT_EQ(result.inliers, 80U) << "seed " << seed;
    EXPECT_EQ(result.usable, 200U) << "seed " << seed;
  }
}

// The largest motion that there is: half a turn about the optical axis.
TEST(RigidRansac, RecoversHalfATurn) {
  Random random(3);
  const Eigen::Isometry3d turned = motionOf({0.0, 0.0, 3.14159265358979}, {0.2, 0.1, 0.0});
  const RigidRansacResult result = rigidRansac(exactPairs(random, 50, turned), kRoundLens);
  ASSERT_TRUE(result.found);
  EXPECT_LT(distanceOf(result.to_from, turned), 1e-9);
  EXPECT_EQ(result.inliers, 50U);
}

// Points in a plane have a mirror image that fits as well; a camera cannot be mirrored.
TEST(RigidRansac, AWallGivesARotationAndNoReflection) {
  Random random(4);
  std::vector<SightedPair> pairs;
  for (int i = 0; i < 60; ++i) {
    Eigen::Vector3d point = anywhere(random);
    point.z() = 2.0;
    pairs.push_back(exactPair(point, kMotion));
  }
  const RigidRansacResult result = rigidRansac(pairs, kRoundLens);
  ASSERT_TRUE(result.found);
  EXPECT_NEAR(result.to_from.linear().determinant(), 1.0, 1e-9);
  EXPECT_LT(distanceOf(result.to_from, kMotion), 1e-9);
}

TEST(RigidRansac, AMirrorImageIsNoMotion) {
  Random random(5);
  std::vector<SightedPair> pairs;
  for (int i = 0; i < 60; ++i) {
    const Eigen::Vector3d point = anywhere(random);
    pairs.push_back({sight(point), sight({-point.x(), point.y(), point.z()})});
  }
  const RigidRansacResult result = rigidRansac(pairs, kRoundLens);
  EXPECT_LT(result.inliers, 15U);
}

TEST(RigidRansac, ThreePairsAreEnough) {
  const std::vector<SightedPair> pairs = {exactPair({0.0, 0.0, 2.0}, kMotion),
                                          exactPair({0.8, 0.0, 2.5}, kMotion),
                                          exactPair({0.0, 0.7, 3.0}, kMotion)};
  const RigidRansacResult result = rigidRansac(pairs, kRoundLens);
  ASSERT_TRUE(result.found);
  EXPECT_EQ(result.inliers, 3U);
  EXPECT_LT(distanceOf(result.to_from, kMotion), 1e-9);
}

TEST(RigidRansac, FewerThanThreePairsAreRefused) {
  Random random(6);
  expectRefused({}, 0);
  expectRefused(exactPairs(random, 1, kMotion), 1);
  expectRefused(exactPairs(random, 2, kMotion), 2);
}

TEST(RigidRansac, PairsOnALineAreRefused) {
  std::vector<SightedPair> pairs;
  pairs.reserve(40);
  for (int i = 0; i < 40; ++i) {
    pairs.push_back(exactPair({-0.8 + 0.04 * i, 0.3 - 0.01 * i, 2.0 + 0.02 * i}, kMotion));
  }
  expectRefused(pairs, 40);
}

TEST(RigidRansac, PairsThatAreAllOneAreRefused) {
  expectRefused(std::vector<SightedPair>(40, exactPair({0.2, 0.1, 2.0}, kMotion)), 40);
}

TEST(RigidRansac, PairsWithoutAUsableDepthAreRefused) {
  Random random(7);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const double depth : {kNan, 0.0, -1.0, HUGE_VAL}) {
    std::vector<SightedPair> pairs = exactPairs(random, 20, kMotion);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      (i % 2 == 0 ? pairs[i].from : pairs[i].to).depth = depth;
    }
    expectRefused(pairs, 0);
  }
}

TEST(RigidRansac, PairsThatAreNotFiniteAreLeftOutAndTheOthersCount) {
  Random random(8);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  std::vector<SightedPair> pairs = exactPairs(random, 30, kMotion);
  std::vector<std::uint8_t> usable(30, 1);
  pairs[3].from.u = kNan;
  pairs[11].from.v = HUGE_VAL;
  pairs[17].to.u = -HUGE_VAL;
  pairs[20].to.depth = kNan;
  for (const std::size_t i : {3U, 11U, 17U, 20U}) {
    usable[i] = 0;
  }
  const RigidRansacResult result = rigidRansac(pairs, kRoundLens);
  ASSERT_TRUE(result.found);
  EXPECT_EQ(result.usable, 26U);
  EXPECT_EQ(result.inlier, usable);
  EXPECT_LT(distanceOf(result.to_from, kMotion), 1e-9);
}

TEST(RigidRansac, AbsurdPixelsDoNoHarm) {
  Random random(9);
  std::vector<SightedPair> pairs = exactPairs(random, 30, kMotion);
  for (std::size_t i = 0; i < 10; ++i) {
    pairs[i].to.u = 1e300;
  }
  const RigidRansacResult result = rigidRansac(pairs, kRoundLens);
  EXPECT_EQ(result.inliers, 20U);
  EXPECT_LT(distanceOf(result.to_from, kMotion), 1e-9);
}

TEST(RigidRansac, PairsWithoutACommonMotionFindFewWhoAgree) {
  Random random(10);
  std::vector<SightedPair> pairs;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d from = anywhere(random);
    pairs.push_back({sight(from), sight(anywhere(random))});
  }
  const RigidRansacResult result = rigidRansac(pairs, kRoundLens);
  EXPECT_LT(result.inliers, 15U);
  EXPECT_EQ(result.iterations, RigidRansacOptions{}.max_iterations);
}

/// 200 exact pairs without a motion, and one more at the end; whether that one is an inlier.
bool agrees(const SightedPair& last,
            const Eigen::Isometry3d& to_from = Eigen::Isometry3d::Identity(), double sigma = 1.0) {
  Random random(11);
  std::vector<SightedPair> pairs;
  pairs.reserve(201);
  for (int i = 0; i < 200; ++i) {
    pairs.push_back(exactPair(anywhere(random), to_from, sigma));
  }
  pairs.push_back(last);
  const RigidRansacResult result = rigidRansac(pairs, kRoundLens);
  EXPECT_EQ(result.inliers, 200U + result.inlier.back());
  return result.inlier.back() != 0;
}

// Without a motion the pixels' variances add up to 2 px^2: sqrt(9.210 * 2) = 4.29 px. The 200
// others leave the motion where it is, up to a fiftieth of a pixel.
TEST(RigidRansac, APixelMayBeOffByThreeSigmaOfBoth) {
  SightedPair pair = exactPair({0.3, 0.2, 2.0}, Eigen::Isometry3d::Identity());
  pair.to.u += 4.2;
  EXPECT_TRUE(agrees(pair));
  pair.to.u += 0.3;
  EXPECT_FALSE(agrees(pair));
  // A key point of a coarse level: variances 1 + 4, sqrt(9.210 * 5) = 6.79 px.
  pair.to.sigma = 2.0;
  EXPECT_TRUE(agrees(pair));
  pair.to.u += 2.5;
  EXPECT_FALSE(agrees(pair));
}

// At 2 m the noise is 0.001 + 1.425e-3 * 4 = 6.7 mm, and what two views do not share 0.3 * 0.01 * 4
// = 12 mm; together 13.7 mm: sqrt(6.635 * 2) * 13.7 mm = 50.1 mm.
TEST(RigidRansac, ADepthMayBeOffByWhatTheSensorIs) {
  SightedPair pair = exactPair({0.3, 0.2, 2.0}, Eigen::Isometry3d::Identity());
  pair.to.depth += 0.048;
  EXPECT_TRUE(agrees(pair));
  pair.to.depth += 0.004;
  EXPECT_FALSE(agrees(pair));
}

// A metre to the side, a point at 5 m and 0.1 m more: its pixel goes 500/5 - 500/5.1 = 1.96 px
// sideways. Of the pixels' 0.2 px alone that would be 6.9 sigma; but the depth's sigma, 36.6 mm,
// makes 0.73 px of it, in this direction and no other.
TEST(RigidRansac, AWrongDepthExcusesThePixelAlongTheEpipolarLineOnly) {
  const Eigen::Isometry3d aside(Eigen::Translation3d(-1.0, 0.0, 0.0));
  const Eigen::Vector3d point(0.5, 0.0, 5.0);
  SightedPair pair = exactPair(point, aside, 0.2);
  pair.from = sight(5.1 / 5.0 * point, 0.2);
  EXPECT_TRUE(agrees(pair, aside, 0.2));
  pair = exactPair(point, aside, 0.2);
  pair.to.v += 1.96;
  EXPECT_FALSE(agrees(pair, aside, 0.2));
}

TEST(RigidRansac, TheSameSeedGivesTheSameResultBitForBit) {
  Random random(12);
  std::vector<SightedPair> pairs;
  for (int i = 0; i < 120; ++i) {
    pairs.push_back(i % 2 == 0 ? exactPair(anywhere(random), kMotion) : wrongPair(random, kMotion));
    pairs.back().to.u += random.normal(1.0);
    pairs.back().to.v += random.normal(1.0);
  }
  RigidRansacOptions options;
  const RigidRansacResult first = rigidRansac(pairs, kRoundLens, options);
  const RigidRansacResult second = rigidRansac(pairs, kRoundLens, options);
  EXPECT_EQ(first.to_from.matrix(), second.to_from.matrix());
  EXPECT_EQ(first.inlier, second.inlier);
  EXPECT_EQ(first.iterations, second.iterations);
  // The seed is what is drawn with: without refits another one ends elsewhere.
  options.refits = 0;
  const RigidRansacResult one = rigidRansac(pairs, kRoundLens, options);
  options.seed = 2;
  const RigidRansacResult other = rigidRansac(pairs, kRoundLens, options);
  EXPECT_GT(distanceOf(one.to_from, other.to_from), 0.0);
}

// 1 px of noise on 200 pairs at 500 px focal length: the fit to all is far better than one to
// three.
TEST(RigidRansac, RefitsAverageTheNoise) {
  Random random(13);
  std::vector<SightedPair> pairs = exactPairs(random, 200, kMotion);
  for (SightedPair& pair : pairs) {
    pair.to.u += random.normal(1.0);
    pair.to.v += random.normal(1.0);
    pair.to.depth += random.normal(0.001 + 1.425e-3 * pair.to.depth * pair.to.depth);
  }
  RigidRansacOptions options;
  const double error = distanceOf(rigidRansac(pairs, kRoundLens, options).to_from, kMotion);
  options.refits = 0;
  EXPECT_LT(error, 0.006);
  EXPECT_LT(error, 0.7 * distanceOf(rigidRansac(pairs, kRoundLens, options).to_from, kMotion));
}

TEST(RigidRansac, MistakesAreNamed) {
  Random random(14);
  std::vector<SightedPair> pairs = exactPairs(random, 5, kMotion);
  const auto messageOf = [&](const auto& change) {
    RigidRansacOptions options;
    change(options);
    return invalidArgumentOf([&] { rigidRansac(pairs, kRoundLens, options); });
  };
  EXPECT_EQ(messageOf([](auto& o) { o.confidence = 1.5; }),
            "options.confidence is 1.500000, expected 0..1");
  EXPECT_EQ(messageOf([](auto& o) { o.max_iterations = 0; }),
            "options.max_iterations is 0, expected at least 1");
  EXPECT_EQ(messageOf([](auto& o) { o.refits = -1; }), "options.refits is -1, expected at least 0");
  EXPECT_EQ(messageOf([](auto& o) { o.min_area = -1.0; }),
            "options.min_area is -1.000000, expected finite and >= 0");
  EXPECT_EQ(messageOf([](auto& o) { o.chi2_pixel = 0.0; }),
            "options.chi2_pixel is 0.000000, expected finite and > 0");
  EXPECT_EQ(invalidArgumentOf([&] {
              rigidRansac(pairs, {0.0, 500.0, 320.0, 240.0});
            }),
            "camera.fx is 0.000000, expected finite and > 0");
  pairs[2].to.sigma = 0.0;
  EXPECT_EQ(invalidArgumentOf([&] { rigidRansac(pairs, kRoundLens); }),
            "pairs[2].to.sigma is 0.000000, expected finite and > 0");
}

}  // namespace
}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <hmcdyn/steps/ego_motion.hpp>

#include "invalid_argument.hpp"
#include "two_view_scene.hpp"

namespace hmcdyn {
namespace {

constexpr PinholeCamera kCamera{500.0, 500.0, 320.0, 240.0};

EgoMotionOptions withBaseline(float baseline_fx) {
  EgoMotionOptions options;
  options.baseline_fx = baseline_fx;
  return options;
}

/// One point's distance for a camera that stood still.
float distanceAtRest(Eigen::Vector2f earlier, float earlier_depth, Eigen::Vector2f current,
                     float current_depth, float baseline_fx) {
  const std::vector<float> u1{earlier.x()}, v1{earlier.y()}, u2{current.x()}, v2{current.y()};
  return egoMotionDistances(kCamera, Eigen::Isometry3d::Identity(), {u1, v1, u2, v2},
                            std::vector<float>{earlier_depth}, std::vector<float>{current_depth},
                            withBaseline(baseline_fx))[0];
}

TEST(EgoMotion, StaticPointsStayWhereTheCameraMotionPutsThem) {
  const Eigen::Isometry3d motion = test::motionOf({2.0, -3.0, 1.0}, {0.2, -0.1, 0.3});
  const test::TwoViewScene scene = test::makeScene(motion, {});
  const std::vector<float> distance =
      egoMotionDistances(test::kSceneCamera, motion, scene.pairs(), scene.earlier_depth,
                         scene.current_depth, withBaseline(40.0f));
  for (const float d : distance) {
    EXPECT_NEAR(d, 0.0, 1e-3);
  }
}

TEST(EgoMotion, SeesAMotionAlongTheEpipolarLine) {
  // Given a camera that moves sideways by 0.1 m, and a point at 2 m that moves 0.04 m the same way:
  // relative to the camera it goes by -0.06 m instead of -0.1 m, in its row.
  const Eigen::Isometry3d motion = test::motionOf({0.0, 0.0, 0.0}, {-0.1, 0.0, 0.0});
  const std::vector<float> u1{320.0f}, v1{260.0f}, u2{320.0f - 15.0f}, v2{260.0f}, depth{2.0f};
  const PointPairsView pairs{u1, v1, u2, v2};

  // When, then: eq. 4 has it on its line; the compensated distance is 500 px * 0.04 m / 2 m.
  EXPECT_NEAR(epipolarDistances(test::fundamentalOf(kCamera, motion), pairs)[0], 0.0, 2e-3);
  EXPECT_NEAR(egoMotionDistances(kCamera, motion, pairs, depth, depth, withBaseline(40.0f))[0],
              10.0, 1e-4);
}

TEST(EgoMotion, SeesAMotionAlongTheRayByItsDisparity) {
  // Given a still camera and pixel, and a depth that goes from 2 m to 1 m: 40 * |1/2 - 1/1|.
  EXPECT_NEAR(distanceAtRest({100, 100}, 2.0f, {100, 100}, 1.0f, 40.0f), 20.0, 1e-4);
  EXPECT_NEAR(distanceAtRest({100, 100}, 2.0f, {100, 100}, 1.0f, 0.0f), 0.0, 1e-4);
  // From 2 m to 2.5 m: 60 * (1/2 - 1/2.5) = 6.
  EXPECT_NEAR(distanceAtRest({100, 100}, 2.0f, {100, 100}, 2.5f, 60.0f), 6.0, 1e-4);
}

TEST(EgoMotion, IsTheNormOfPixelsAndDisparity) {
  // du = 3, dv = 4, 24 * (1/1 - 1/2) = 12.
  EXPECT_NEAR(distanceAtRest({100, 100}, 1.0f, {103, 104}, 2.0f, 24.0f), 13.0, 1e-4);
}

TEST(EgoMotion, ForwardMotionScalesAboutThePrincipalPoint) {
  // Given a point at 2 m, 100 px off the centre, and a camera 1 m forward: 200 px off, at 1 m.
  const Eigen::Isometry3d motion = test::motionOf({0.0, 0.0, 0.0}, {0.0, 0.0, -1.0});
  const std::vector<float> u1{420.0f}, v1{240.0f}, u2{520.0f}, v2{240.0f};
  const std::vector<float> earlier{2.0f}, current{1.0f};
  EXPECT_NEAR(egoMotionDistances(kCamera, motion, {u1, v1, u2, v2}, earlier, current,
                                 withBaseline(40.0f))[0],
              0.0, 1e-4);
}

TEST(EgoMotion, WithoutTheEarlierDepthThereIsNoDistance) {
  for (const float none : {0.0f, -1.0f, kNaN, std::numeric_limits<float>::infinity()}) {
    EXPECT_TRUE(std::isnan(distanceAtRest({100, 100}, none, {100, 100}, 1.0f, 40.0f))) << none;
  }
}

TEST(EgoMotion, WithoutTheCurrentDepthThePixelsDecide) {
  for (const float none : {0.0f, -1.0f, kNaN, std::numeric_limits<float>::infinity()}) {
    EXPECT_NEAR(distanceAtRest({100, 100}, 2.0f, {103, 104}, none, 40.0f), 5.0, 1e-4) << none;
  }
}

TEST(EgoMotion, WithoutAMatchThereIsNoDistance) {
  EXPECT_TRUE(std::isnan(distanceAtRest({kNaN, 100}, 2.0f, {100, 100}, 2.0f, 40.0f)));
  EXPECT_TRUE(std::isnan(distanceAtRest({100, kNaN}, 2.0f, {100, 100}, 2.0f, 40.0f)));
  EXPECT_TRUE(std::isnan(distanceAtRest({100, 100}, 2.0f, {kNaN, 100}, 2.0f, 40.0f)));
  const float infinity = std::numeric_limits<float>::infinity();
  EXPECT_TRUE(std::isnan(distanceAtRest({infinity, 100}, 2.0f, {100, 100}, 2.0f, 40.0f)));
  EXPECT_TRUE(std::isnan(distanceAtRest({100, 100}, 2.0f, {100, infinity}, 2.0f, 40.0f)));
}

TEST(EgoMotion, BehindTheCameraThereIsNoDistance) {
  // Given a camera that went 3 m forward past a point at 2 m, or right onto it.
  const std::vector<float> u{320.0f}, v{240.0f}, depth{2.0f};
  for (const double forward : {3.0, 2.0}) {
    const Eigen::Isometry3d motion = test::motionOf({0.0, 0.0, 0.0}, {0.0, 0.0, -forward});
    EXPECT_TRUE(std::isnan(
        egoMotionDistances(kCamera, motion, {u, v, u, v}, depth, depth, withBaseline(40.0f))[0]));
  }
}

TEST(EgoMotion, ReusedMemoryLeavesNothingBehind) {
  const std::vector<float> u{320.0f}, v{240.0f}, none{0.0f};
  const std::vector<float> distance =
      egoMotionDistances(kCamera, Eigen::Isometry3d::Identity(), {u, v, u, v}, none, none,
                         withBaseline(40.0f), std::vector<float>(5, 3.0f));
  ASSERT_EQ(distance.size(), 1U);
  EXPECT_TRUE(std::isnan(distance[0]));
}

TEST(EgoMotion, UnequalSizesAreRefused) {
  const std::vector<float> two(2, 1.0f), three(3, 1.0f);
  const PointPairsView pairs{two, two, two, two};
  const Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  EXPECT_EQ(
      test::invalidArgumentOf(
          [&] { egoMotionDistances(kCamera, motion, pairs, two, three, EgoMotionOptions{}); }),
      "egoMotionDistances: 2 pairs, but 2 earlier and 3 current depths; expected equal sizes");
  EXPECT_NE(test::invalidArgumentOf([&] {
              egoMotionDistances(kCamera, motion, {two, three, two, two}, two, two);
            }),
            "nothing thrown");
}

TEST(EgoMotion, BadBaselinesAreRefused) {
  for (const float bad : {-1.0f, kNaN, std::numeric_limits<float>::infinity()}) {
    EXPECT_EQ(test::invalidArgumentOf([&] {
                distanceAtRest({100, 100}, 2.0f, {100, 100}, 2.0f, bad);
              }),
              "egoMotionDistances: baseline_fx is " + std::to_string(bad) +
                  "; expected a finite value >= 0 (px m)");
  }
}

}  // namespace
}  // namespace hmcdyn

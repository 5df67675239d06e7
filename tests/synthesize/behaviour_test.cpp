// SPDX-License-Identifier: BSD-3-Clause
#include "synthesize/behaviour.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "synthesize/body.hpp"
#include "synthesize/paint.hpp"
#include "synthesize/random.hpp"

namespace hmcdyn::synthesize {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

// Order of bodyPoses(): pelvis, chest, head, two arms of two parts, two legs of three.
constexpr std::size_t kPelvis = 0;
constexpr std::size_t kHead = 2;
constexpr std::size_t kLeftFoot = 9;
constexpr std::size_t kRightFoot = 12;
constexpr double kHeight = 1.8;

Behaviour straightWalk(double speed) {
  Behaviour b;
  b.seed = 5;
  b.actions = {walkTo(100.0, 0.0, speed)};
  return b;
}

double speedOf(const Performance& person, std::size_t part, double time) {
  const double h = 1.0 / 60.0;
  return (bodyPoses(kHeight, person.at(time + h))[part].translation() -
          bodyPoses(kHeight, person.at(time - h))[part].translation())
             .norm() /
         (2.0 * h);
}

TEST(Behaviour, WalksAtTheAskedSpeed) {
  const Performance person(straightWalk(1.2), 10.0);
  EXPECT_NEAR(person.at(9.0).x - person.at(4.0).x, 5.0 * 1.2, 0.02);
  EXPECT_NEAR(person.at(9.0).y, 0.0, 1e-9);
}

TEST(Behaviour, OneFootStandsWhileTheOtherSwings) {
  const Performance person(straightWalk(1.0), 10.0);
  double fastest = 0.0;
  for (double time = 4.0; time < 8.0; time += 0.02) {
    const double left = speedOf(person, kLeftFoot, time);
    const double right = speedOf(person, kRightFoot, time);
    // Turning over heel and toes moves the ankle a little.
    EXPECT_LT(std::min(left, right), 0.35) << "at " << time << " s";
    fastest = std::max({fastest, left, right});
  }
  EXPECT_GT(fastest, 2.0);
}

TEST(Behaviour, FootFlatOnTheFloorDoesNotSlide) {
  const Performance person(straightWalk(1.0), 10.0);
  int resting = 0;
  for (double time = 4.0; time < 8.0; time += 0.02) {
    resting += speedOf(person, kLeftFoot, time) < 0.05 ? 1 : 0;
  }
  EXPECT_GT(resting, 40);  // of 200: at least a fifth of the time
}

TEST(Behaviour, FeetStayOnOrAboveTheFloor) {
  const Performance person(straightWalk(1.1), 10.0);
  for (double time = 3.0; time < 8.0; time += 0.03) {
    const auto poses = bodyPoses(kHeight, person.at(time));
    for (const std::size_t foot : {kLeftFoot, kRightFoot}) {
      // The sole is 0.045 of the height below the ankle.
      EXPECT_GT(poses[foot].translation().z() - 0.045 * kHeight, -0.03) << "at " << time << " s";
    }
  }
}

TEST(Behaviour, StandingPersonIsSlowerThanACentimetreASecond) {
  Behaviour b;
  b.seed = 3;
  b.actions = {standFor(100.0, 0.0)};
  const Performance person(b, 10.0);
  for (double time = 0.5; time < 9.0; time += 0.1) {
    for (std::size_t part = 0; part <= kRightFoot; ++part) {
      EXPECT_LT(speedOf(person, part, time), 0.006) << "part " << part << " at " << time << " s";
    }
  }
}

TEST(Behaviour, TalkingPersonMovesArmsButStaysInPlace) {
  Behaviour b;
  b.seed = 3;
  b.starts_seated = true;
  b.actions = {sitFor(100.0, 0.0, 1.0)};
  const Performance person(b, 10.0);
  double fastest_hand = 0.0;
  for (double time = 2.0; time < 9.0; time += 0.1) {
    fastest_hand = std::max(fastest_hand, speedOf(person, 4, time));
    EXPECT_LT(speedOf(person, kPelvis, time), 0.002);
    EXPECT_LT(speedOf(person, kLeftFoot, time), 0.002);
  }
  EXPECT_GT(fastest_hand, 0.1);
}

TEST(Behaviour, SitsDownOnAChairAndGetsUpAgain) {
  Behaviour b;
  b.seed = 3;
  b.actions = {standFor(1.0, 0.0), sitFor(4.0, 0.0), standFor(3.0, 0.0)};
  const Performance person(b, 12.0);
  const auto headAt = [&](double time) {
    return bodyPoses(kHeight, person.at(time))[kHead].translation().z();
  };
  EXPECT_NEAR(headAt(0.5), (0.525 + 0.08 + 0.255) * kHeight, 0.02);
  EXPECT_LT(headAt(4.0), 1.3);
  EXPECT_NEAR(headAt(7.5), headAt(0.5), 0.02);
}

TEST(Behaviour, LagStartsInTheMiddleOfTheActions) {
  Behaviour b = straightWalk(1.0);
  const Performance now(b, 8.0);
  b.lag = 3.0;
  const Performance later(b, 5.0);
  EXPECT_NEAR(later.at(1.0).x, now.at(4.0).x, 0.3);
}

TEST(Behaviour, SameSeedSameMovement) {
  const Performance a(straightWalk(1.0), 3.0);
  const Performance b(straightWalk(1.0), 3.0);
  EXPECT_EQ(a.at(2.1).phase, b.at(2.1).phase);
  EXPECT_EQ(a.at(2.1).head_yaw, b.at(2.1).head_yaw);
}

TEST(Behaviour, RefusesNothingToDo) {
  EXPECT_THROW(Performance(Behaviour{}, 1.0), std::invalid_argument);
  EXPECT_THROW(Performance(straightWalk(1.0), 0.0), std::invalid_argument);
}

TEST(Body, LooksHaveHumanHeights) {
  for (std::uint64_t seed = 1; seed < 50; ++seed) {
    const BodyLook look = randomLook(seed);
    EXPECT_GE(look.height, 1.65);
    EXPECT_LE(look.height, 1.90);
  }
}

TEST(Body, StandsAsTallAsItsLookSays) {
  TextureLibrary textures;
  BodyLook look;
  look.height = kHeight;
  const std::vector<LitMesh> parts = buildBody(textures, look);
  const std::vector<Isometry3d> poses = bodyPoses(look.height, Posture{});
  ASSERT_EQ(parts.size(), poses.size());
  double low = 10.0;
  double high = 0.0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    for (const Vertex& vertex : parts[i].mesh.vertices) {
      const double z = (poses[i] * vertex.position.cast<double>()).z();
      low = std::min(low, z);
      high = std::max(high, z);
    }
  }
  EXPECT_NEAR(low, 0.0, 0.01);
  EXPECT_NEAR(high, kHeight, 0.06);
}

TEST(Body, BonesKeepTheirLengthInEveryPosture) {
  const Performance person(straightWalk(1.3), 6.0);
  for (double time = 0.0; time < 5.0; time += 0.1) {
    const auto poses = bodyPoses(kHeight, person.at(time));
    // Thigh from hip to knee, shin from knee to ankle, on the left.
    EXPECT_NEAR((poses[8].translation() - poses[7].translation()).norm(), 0.245 * kHeight, 1e-6);
    EXPECT_NEAR((poses[9].translation() - poses[8].translation()).norm(), 0.246 * kHeight, 1e-6);
  }
}

TEST(Performance, SaysWhenAnActionBegins) {
  Behaviour b;
  b.actions = {standFor(1.0, 0.0), walkTo(2.0, 0.0), standFor(100.0, 0.0), standFor(1.0, 0.0)};
  const Performance performance(b, 10.0);
  // Given by samples of 1/120 s, after the quarter of a second that is kept before the first frame
  EXPECT_NEAR(performance.startOf(1), 0.75, 0.02);
  const double arrival = performance.startOf(2);
  EXPECT_NEAR(performance.at(arrival).x, 2.0, 0.1);
  EXPECT_GT(arrival, 0.75 + 2.0);
  EXPECT_TRUE(std::isinf(performance.startOf(3)));
  EXPECT_THROW(performance.startOf(4), std::out_of_range);
}

TEST(Paint, APointIsDrawnFromBelow) {
  // Given the same stream twice
  Random one(7);
  Random other(7);
  const cv::Point point = paint::randomPoint(one, {0, 99}, {0, 99});
  // Then y is the first number of the stream, whatever the compiler
  EXPECT_EQ(point.y, other.integer(0, 99));
  EXPECT_EQ(point.x, other.integer(0, 99));
}

}  // namespace
}  // namespace hmcdyn::synthesize

// SPDX-License-Identifier: BSD-3-Clause
#include "slam/loop/loop_closer.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "invalid_argument.hpp"
#include "loop/tour.hpp"

namespace hmcdyn::slam {
namespace {

using hmcdyn::test::invalidArgumentOf;
using namespace hmcdyn::slam::test;  // NOLINT(google-build-using-namespace): the scene's words

constexpr std::size_t kBack = Tour::kRound;  // the key frame that is where the first one was

/// 0.1 degrees and 3 mm a step, all to one side: 5.5 degrees at the end of the round.
const Drift kDrift{{0.0, 0.002, 0.0005}, {0.003, 0.001, 0.0}};

LoopCloserOptions poseGraphOnly() {
  LoopCloserOptions options;
  options.bundle_adjustment = false;
  return options;
}

Eigen::Isometry3d along(double x) { return motionOf(Eigen::Vector3d::Zero(), {-x, 0.0, 0.0}); }

double placeOf(const CorrectedPose& pose) {
  return pose.camera_from_world.inverse().translation().x();
}

/// Key frames at 0, 1, 2, 3 m, each tied to the next by 100 points, and a loop from the first to
/// the last.
LoopSnapshot line(double loop_length) {
  LoopSnapshot snapshot;
  snapshot.camera = kLens;
  for (std::size_t k = 0; k < 4; ++k) {
    snapshot.key_frames.push_back({10 + k, along(static_cast<double>(k))});
    if (k > 0) {
      snapshot.covisibility.push_back({9 + k, 10 + k, 100});
    }
  }
  LoopConstraint loop;
  loop.from = 10;
  loop.to = 13;
  loop.to_from = along(loop_length);
  loop.information *= 1e12;
  snapshot.loops.push_back(loop);
  return snapshot;
}

// By hand. Three ties and a loop, each of 1 cm: of 8 cm too much each of the four takes 2 cm.
TEST(LoopCloser, TiesAndLoopShareTheError) {
  const LoopClosure closure = closeLoops(line(3.08), poseGraphOnly());
  EXPECT_FALSE(closure.refused);
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(closure.key_frames[k].id, 10 + k);
    EXPECT_NEAR(placeOf(closure.key_frames[k]), 1.02 * static_cast<double>(k), 1e-5);
  }
  EXPECT_NEAR(closure.largest_correction, 0.06, 1e-5);
  ASSERT_EQ(closure.loop_error.size(), 1U);
  EXPECT_NEAR(closure.loop_error[0], 4.0, 1e-2);  // (2 cm / 1 cm)^2
}

// By hand. The middle tie is of 25 points, a quarter of the information: it gives four times as
// much as the others, (1 + 4 + 1 + 1) shares of 7 cm.
TEST(LoopCloser, ATieOfFewPointsGivesMore) {
  LoopSnapshot snapshot = line(3.07);
  snapshot.covisibility[1].weight = 25;
  const LoopClosure closure = closeLoops(snapshot, poseGraphOnly());
  EXPECT_NEAR(placeOf(closure.key_frames[1]), 1.01, 1e-5);
  EXPECT_NEAR(placeOf(closure.key_frames[2]), 2.05, 1e-5);
  EXPECT_NEAR(placeOf(closure.key_frames[3]), 3.06, 1e-5);
}

// Ties over several key frames say again what those between say: the chain must not become stiffer
// by them. With all six ties the step in the middle is spanned by four, the outer ones by three, so
// that the shares differ a little from a quarter.
TEST(LoopCloser, TiesAlongThePathDoNotStiffenIt) {
  LoopSnapshot snapshot = line(3.08);
  for (const auto& [a, b] :
       {std::make_pair(10, 12), std::make_pair(11, 13), std::make_pair(10, 13)}) {
    snapshot.covisibility.push_back(
        {static_cast<std::size_t>(a), static_cast<std::size_t>(b), 100});
  }
  const LoopClosure closure = closeLoops(snapshot, poseGraphOnly());
  EXPECT_NEAR(placeOf(closure.key_frames[3]), 3.06, 0.002);
}

// By hand. A tie between the ends, where the path was elsewhere between, stands for itself: it
// wants 3 m, as do the three in a row with a third of its strength; the loop, as strong, 3.05 m.
TEST(LoopCloser, ATieBackToAPlaceHolds) {
  LoopSnapshot snapshot = line(3.05);
  snapshot.covisibility.push_back({10, 13, 100});
  const LoopClosure closure = closeLoops(snapshot, poseGraphOnly());
  EXPECT_FALSE(closure.refused);
  EXPECT_NEAR(placeOf(closure.key_frames[3]), 3.0 + 0.05 / (1.0 + 1.0 + 1.0 / 3.0), 1e-4);
}

TEST(LoopCloser, PointsMoveWithTheirKeyFrames) {
  LoopSnapshot snapshot = line(3.08);
  snapshot.key_frames[2].camera_from_world = motionOf({0.0, 0.5, 0.0}, {-2.0, 0.1, 0.0});
  const Eigen::Vector3d place(2.5, -0.3, 2.0);
  snapshot.points = {{5, place, 12}, {6, place, 10}, {9, place, 13}};
  const LoopClosure closure = closeLoops(snapshot, poseGraphOnly());
  ASSERT_EQ(closure.points.size(), 3U);
  EXPECT_EQ(closure.points[0].id, 5);
  EXPECT_EQ(closure.points[0].fused_into, 5);
  // In its key frame it is where it was.
  const Eigen::Vector3d before = snapshot.key_frames[2].camera_from_world * place;
  const Eigen::Vector3d after =
      closure.key_frames[2].camera_from_world * closure.points[0].position;
  EXPECT_LT((after - before).norm(), 1e-12);
  EXPECT_GT((closure.points[0].position - place).norm(), 0.01);
  EXPECT_LT((closure.points[1].position - place).norm(), 1e-12);  // that of the first stays
}

// The pose graph alone: what the drift's turn did is undone but for the share of the loop's own
// sigma. The error in each step's length cannot be seen from a round, and stays.
TEST(LoopCloser, APoseGraphClosesTheRound) {
  Tour tour = makeTour({{0.0, 0.005, 0.0}, Eigen::Vector3d::Zero()});
  EXPECT_GT(metresBetween(tour.snapshot.key_frames[kBack].camera_from_world, tour.truth[kBack]),
            0.1);
  tour.snapshot.loops.push_back(trueLoop(tour, 0, kBack));
  const LoopClosure closure = closeLoops(tour.snapshot, poseGraphOnly());
  EXPECT_FALSE(closure.refused);
  EXPECT_LT(metresBetween(closure.key_frames[kBack].camera_from_world, tour.truth[kBack]), 0.005);
  EXPECT_LT(largestError(closure.key_frames, tour),
            0.1 * largestError(tour.snapshot.key_frames, tour));
}

TEST(LoopCloser, ATourWithDriftIsClosedToTheTruth) {
  Tour tour = makeTour(kDrift);
  EXPECT_GT(largestError(tour.snapshot.key_frames, tour), 0.1);
  tour.snapshot.loops.push_back(trueLoop(tour, 0, kBack));
  const LoopClosure closure = closeLoops(tour.snapshot);
  EXPECT_FALSE(closure.refused);
  EXPECT_LT(largestError(closure.key_frames, tour), 1e-4);
  EXPECT_EQ(closure.key_frames[0].camera_from_world.matrix(),
            tour.snapshot.key_frames[0].camera_from_world.matrix());
  ASSERT_EQ(closure.points.size(), tour.true_point.size());
  for (std::size_t i = 0; i < closure.points.size(); ++i) {
    EXPECT_LT((closure.points[i].position - tour.true_point[i]).norm(), 1e-3) << i;
  }
  EXPECT_GT(closure.largest_correction, 0.1);
  EXPECT_LT(closure.loop_error[0], 1e-6);
  EXPECT_EQ(std::count(closure.inlier.begin(), closure.inlier.end(), 1),
            static_cast<std::ptrdiff_t>(tour.snapshot.sightings.size()));
}

// With 1 px and the sensor's depth noise the adjustment alone is left with what the noise adds up
// to around the hall; the points that the loop makes one hold it shut.
TEST(LoopCloser, FusedPointsHoldTheLoopShutAgainstNoise) {
  Tour tour = makeTour(kDrift, {1.0, 1.0, 0});
  LoopCloserOptions options;
  options.bundle.depth_error.systematic_quadratic = 0.0f;  // the tour's camera has noise alone
  const double open = largestError(closeLoops(tour.snapshot, options).key_frames, tour);
  const double before = largestError(tour.snapshot.key_frames, tour);
  tour.snapshot.loops.push_back(trueLoop(tour, 0, kBack));
  const LoopClosure closure = closeLoops(tour.snapshot, options);
  EXPECT_FALSE(closure.refused);
  EXPECT_LT(largestError(closure.key_frames, tour), 0.6 * open);
  EXPECT_LT(largestError(closure.key_frames, tour), 0.2 * before);
}

TEST(LoopCloser, PointsThatAreOneBecomeOne) {
  Tour tour = makeTour(kDrift);
  const LoopConstraint loop = trueLoop(tour, 0, kBack);
  ASSERT_GT(loop.map_points.size(), 50U);
  tour.snapshot.loops.push_back(loop);
  const LoopClosure closure = closeLoops(tour.snapshot);
  EXPECT_EQ(closure.fused, loop.map_points.size());
  for (const auto& [first, second] : loop.map_points) {
    const CorrectedPoint& gone = closure.points[static_cast<std::size_t>(second)];
    EXPECT_EQ(gone.fused_into, first);
    EXPECT_EQ(gone.position, closure.points[static_cast<std::size_t>(first)].position);
    EXPECT_EQ(closure.points[static_cast<std::size_t>(first)].fused_into, first);
  }
}

// 1 = 2 and 2 = 3 make 1 of all three, in whatever order they are said; a culled one is passed
// over.
TEST(LoopCloser, FusionsAddUp) {
  LoopSnapshot snapshot = line(3.0);
  for (const int id : {1, 2, 3, 4}) {
    snapshot.points.push_back({id, {static_cast<double>(id), 0.0, 2.0}, 10});
  }
  snapshot.loops[0].map_points = {{3, 2}, {2, 1}, {4, 99}};
  const LoopClosure closure = closeLoops(snapshot, poseGraphOnly());
  EXPECT_EQ(closure.fused, 2U);
  for (const std::size_t i : {0U, 1U, 2U}) {
    EXPECT_EQ(closure.points[i].fused_into, 1);
    EXPECT_NEAR(closure.points[i].position.x(), 1.0, 1e-12);
  }
  EXPECT_EQ(closure.points[3].fused_into, 4);
}

// False loops: the detector was deceived, and a hundred points are said to be one.

void expectAsGiven(const LoopClosure& closure, const LoopSnapshot& snapshot) {
  ASSERT_EQ(closure.key_frames.size(), snapshot.key_frames.size());
  for (std::size_t i = 0; i < closure.key_frames.size(); ++i) {
    EXPECT_EQ(closure.key_frames[i].camera_from_world.matrix(),
              snapshot.key_frames[i].camera_from_world.matrix());
  }
  ASSERT_EQ(closure.points.size(), snapshot.points.size());
  for (std::size_t i = 0; i < closure.points.size(); ++i) {
    EXPECT_EQ(closure.points[i].position, snapshot.points[i].position);
    EXPECT_EQ(closure.points[i].fused_into, snapshot.points[i].id);
  }
  EXPECT_EQ(closure.fused, 0U);
  EXPECT_TRUE(closure.inlier.empty());
  EXPECT_EQ(closure.largest_correction, 0.0);
}

/// Two places that are called one, and a hundred pairs of their points with them.
LoopConstraint falseLoop(const Tour& tour, std::size_t from, std::size_t to) {
  LoopConstraint loop = trueLoop(tour, from, to);
  loop.to_from = Eigen::Isometry3d::Identity();
  std::vector<int> of_from;
  std::vector<int> of_to;
  for (const auto& sighting : tour.snapshot.sightings) {
    if (sighting.key_frame == from) {
      of_from.push_back(sighting.point);
    } else if (sighting.key_frame == to) {
      of_to.push_back(sighting.point);
    }
  }
  loop.map_points.clear();
  for (std::size_t i = 0; i < std::min({of_from.size(), of_to.size(), std::size_t{100}}); ++i) {
    if (of_from[i] != of_to[i]) {
      loop.map_points.emplace_back(of_from[i], of_to[i]);
    }
  }
  return loop;
}

TEST(LoopCloser, AFalseLoopIsRefusedAndLeavesTheMapAsItWas) {
  for (const std::size_t to : {12U, 24U, 40U}) {
    Tour tour = makeTour(kDrift, {1.0, 1.0, 0});
    tour.snapshot.loops.push_back(falseLoop(tour, 0, to));
    const LoopClosure closure = closeLoops(tour.snapshot);
    ASSERT_TRUE(closure.refused) << "to " << to;
    EXPECT_EQ(*closure.refused, 0U);
    EXPECT_GT(closure.loop_error[0], 1000.0) << "to " << to;
    expectAsGiven(closure, tour.snapshot);
  }
}

// The most tempting: the right place, seen from 10 cm beside where it was.
TEST(LoopCloser, ALoopThatIsAHandsBreadthOffIsRefused) {
  Tour tour = makeTour(kDrift, {1.0, 1.0, 0});
  LoopConstraint loop = trueLoop(tour, 0, kBack);
  loop.to_from = motionOf({0.0, 0.03, 0.0}, {0.1, 0.0, 0.0}) * loop.to_from;
  tour.snapshot.loops.push_back(loop);
  const LoopClosure closure = closeLoops(tour.snapshot);
  ASSERT_TRUE(closure.refused);
  expectAsGiven(closure, tour.snapshot);
}

TEST(LoopCloser, OfTrueAndFalseLoopsTheFalseOneIsNamed) {
  Tour tour = makeTour(kDrift, {1.0, 1.0, 0});
  tour.snapshot.loops = {trueLoop(tour, 0, kBack), falseLoop(tour, 5, 30),
                         trueLoop(tour, 1, kBack + 1)};
  const LoopClosure closure = closeLoops(tour.snapshot);
  ASSERT_TRUE(closure.refused);
  EXPECT_EQ(*closure.refused, 1U);
  expectAsGiven(closure, tour.snapshot);
  tour.snapshot.loops.erase(tour.snapshot.loops.begin() + 1);
  const LoopClosure again = closeLoops(tour.snapshot);
  EXPECT_FALSE(again.refused);
  EXPECT_LT(largestError(again.key_frames, tour), 0.03);
}

// Without the adjustment the pose graph's own tension tells.
TEST(LoopCloser, TheTensionOfThePoseGraphRefusesToo) {
  const LoopSnapshot snapshot = line(4.0);
  const LoopClosure closure = closeLoops(snapshot, poseGraphOnly());
  ASSERT_TRUE(closure.refused);
  EXPECT_GT(closure.loop_error[0], 1000.0);
  expectAsGiven(closure, snapshot);
}

TEST(LoopCloser, WithoutALoopThePosesOfAnExactMapStay) {
  const Tour tour = makeTour({});
  const LoopClosure closure = closeLoops(tour.snapshot);
  EXPECT_FALSE(closure.refused);
  EXPECT_TRUE(closure.loop_error.empty());
  EXPECT_LT(largestError(closure.key_frames, tour), 1e-4);
  EXPECT_EQ(closure.fused, 0U);
}

TEST(LoopCloser, AnEmptyMapIsNothingToDo) {
  LoopSnapshot nothing;
  nothing.camera = kLens;
  const LoopClosure closure = closeLoops(nothing);
  EXPECT_TRUE(closure.key_frames.empty());
  EXPECT_TRUE(closure.points.empty());
  EXPECT_EQ(closure.pose_graph.termination, PoseGraphTermination::kNothingToDo);
}

TEST(LoopCloser, TheSameMapGivesTheSameResultBitForBit) {
  Tour tour = makeTour(kDrift, {1.0, 1.0, 0});
  tour.snapshot.loops.push_back(trueLoop(tour, 0, kBack));
  const LoopClosure one = closeLoops(tour.snapshot);
  const LoopClosure other = closeLoops(tour.snapshot);
  for (std::size_t i = 0; i < one.key_frames.size(); ++i) {
    EXPECT_EQ(one.key_frames[i].camera_from_world.matrix(),
              other.key_frames[i].camera_from_world.matrix());
  }
  for (std::size_t i = 0; i < one.points.size(); ++i) {
    EXPECT_EQ(one.points[i].position, other.points[i].position);
  }
  EXPECT_EQ(one.inlier, other.inlier);
  EXPECT_EQ(one.loop_error, other.loop_error);
}

TEST(LoopCloser, MistakesAreNamed) {
  const auto messageOf = [](const auto& change) {
    LoopSnapshot snapshot = line(3.0);
    snapshot.points.push_back({5, {0.0, 0.0, 2.0}, 10});
    LoopCloserOptions options;
    change(snapshot, options);
    return invalidArgumentOf([&] { closeLoops(snapshot, options); });
  };
  EXPECT_EQ(messageOf([](auto& s, auto&) { s.key_frames[1].id = 10; }),
            "key frames is 10, expected each id once");
  EXPECT_EQ(messageOf([](auto& s, auto&) { s.points.push_back(s.points[0]); }),
            "points is 5, expected each id once");
  EXPECT_EQ(messageOf([](auto& s, auto&) { s.loops[0].to = 99; }),
            "loops.to is 99, expected the id of one of the snapshot's key frames");
  EXPECT_EQ(messageOf([](auto& s, auto&) { s.covisibility[0].a = 99; }),
            "covisibility.a is 99, expected the id of one of the snapshot's key frames");
  EXPECT_EQ(messageOf([](auto& s, auto&) { s.points[0].anchor = 99; }),
            "points.anchor is 99, expected the id of one of the snapshot's key frames");
  EXPECT_EQ(messageOf([](auto& s, auto&) {
              s.sightings.push_back({10, 6});
            }),
            "sightings.point is 6, expected the id of one of the snapshot's points");
  EXPECT_EQ(messageOf([](auto&, auto& o) { o.reference_covisibility = 0; }),
            "options.reference_covisibility is 0, expected at least 1");
  EXPECT_EQ(messageOf([](auto&, auto& o) { o.loop_sigma_translation = 0.0; }),
            "options.loop_sigma_translation is 0.000000, expected finite and > 0");
  EXPECT_EQ(messageOf([](auto&, auto& o) { o.max_loop_error = -1.0; }),
            "options.max_loop_error is -1.000000, expected finite and > 0");
}

}  // namespace
}  // namespace hmcdyn::slam

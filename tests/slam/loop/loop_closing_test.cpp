// SPDX-License-Identifier: BSD-3-Clause
#include "slam/loop/loop_closing.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "invalid_argument.hpp"
#include "loop/map_tour.hpp"

namespace hmcdyn::slam {
namespace {

using hmcdyn::test::invalidArgumentOf;
using namespace hmcdyn::slam::test;  // NOLINT(google-build-using-namespace): the scene's words

const Drift kDrift{{0.0, 0.002, 0.0005}, {0.003, 0.001, 0.0}};
constexpr std::size_t kBack = Tour::kRound;
constexpr std::size_t kFound = 46;  // the key frame that has the first ones well in view again

/// A hall whose one half looks like the other, down to each point.
Landmarks twinHall() {
  Landmarks half;
  for (const Landmark& landmark : hall(78, 1500)) {
    if (landmark.position.x() > 0.0) {
      half.push_back(landmark);
    }
  }
  Landmarks both = half;
  add(both, movedBy(half, motionOf({0.0, std::acos(-1.0), 0.0}, Eigen::Vector3d::Zero())));
  return both;
}

/// A frame's dealings with the loop thread, as the pipeline has them. Whether the map was moved.
bool exchange(MapTour& tour, LoopClosing& loops) {
  const std::optional<MapCorrection> correction = loops.poll(tour.map);
  if (correction) {
    tour.map.apply(*correction);
  }
  return correction.has_value();
}

/// Up to this many key frames, three frames each.
bool walk(MapTour& tour, LoopClosing& loops, std::size_t key_frames) {
  bool moved = false;
  while (tour.truth.size() < key_frames) {
    tour.step();
    loops.process(tour.map);
    for (int frame = 0; frame < 3; ++frame) {
      moved = exchange(tour, loops) || moved;
    }
  }
  return moved;
}

/// Corrections that are taken up until there is none left.
int finish(MapTour& tour, LoopClosing& loops) {
  int corrections = 0;
  while (const std::optional<MapCorrection> correction = loops.finish(tour.map)) {
    tour.map.apply(*correction);
    ++corrections;
  }
  return corrections;
}

std::ptrdiff_t countOf(const std::vector<LoopEvent>& events, const std::string& refusal) {
  return std::count_if(events.begin(), events.end(),
                       [&](const LoopEvent& event) { return event.refusal == refusal; });
}

void expectSameMap(const Map& a, const Map& b) {
  ASSERT_EQ(a.keyFrames().size(), b.keyFrames().size());
  for (std::size_t k = 0; k < a.keyFrames().size(); ++k) {
    EXPECT_EQ(a.poseOf(static_cast<int>(k)).matrix(), b.poseOf(static_cast<int>(k)).matrix());
    EXPECT_EQ(a.keyFrames()[k].frame.map_point, b.keyFrames()[k].frame.map_point);
  }
  ASSERT_EQ(a.points().size(), b.points().size());
  for (std::size_t i = 0; i < a.points().size(); ++i) {
    EXPECT_EQ(a.points()[i].position, b.points()[i].position);
    EXPECT_EQ(a.points()[i].removed, b.points()[i].removed);
    EXPECT_EQ(a.points()[i].observations.size(), b.points()[i].observations.size());
  }
}

TEST(LoopClosing, ARoundIsClosedAndTheMapIsOne) {
  MapTour tour(hall(77, 1500), kDrift);
  LoopClosing loops(kLens, {});
  EXPECT_FALSE(walk(tour, loops, kFound));
  EXPECT_EQ(loops.loopsClosed(), 0U);
  EXPECT_GT(tour.worstPose(), 0.1);
  EXPECT_TRUE(walk(tour, loops, kFound + 1));
  EXPECT_EQ(loops.loopsClosed(), 1U);
  EXPECT_LT(tour.worstPose(), 0.005);
  const std::vector<LoopEvent> events = loops.takeEvents();
  ASSERT_EQ(countOf(events, ""), 1);
  const auto accepted = std::find_if(events.begin(), events.end(),
                                     [](const LoopEvent& event) { return event.refusal.empty(); });
  EXPECT_NEAR(accepted->timestamp, 0.1 * static_cast<double>(kFound), 1e-9);
  EXPECT_LT(accepted->matched_timestamp, 0.5);
  EXPECT_GE(accepted->inliers, LoopVerificationOptions{}.min_inliers);
  // What is seen now is what was seen first.
  const auto shared = tour.map.covisible(static_cast<int>(kFound));
  EXPECT_TRUE(std::any_of(shared.begin(), shared.end(),
                          [](const auto& other) { return other.first < 5 && other.second >= 30; }));
  EXPECT_TRUE(loops.takeEvents().empty());
}

TEST(LoopClosing, RunsRepeatBitForBit) {
  const auto run = [] {
    MapTour tour(hall(77, 1500), kDrift);
    LoopClosing loops(kLens, {});
    walk(tour, loops, kBack + 5);
    finish(tour, loops);
    return tour.map;
  };
  expectSameMap(run(), run());
}

// The detector is deceived, and rightly so: each point is where and as it was. But the way there
// was half a round.
TEST(LoopClosing, AFalseLoopIsRefusedAndLeavesTheMapBitForBit) {
  MapTour deceived(twinHall(), kDrift);
  MapTour alone(twinHall(), kDrift);
  LoopClosing loops(kLens, {});
  const std::size_t half = Tour::kRound / 2;
  EXPECT_FALSE(walk(deceived, loops, half + 6));
  EXPECT_EQ(finish(deceived, loops), 0);
  while (alone.truth.size() < half + 6) {
    alone.step();
  }
  EXPECT_GE(countOf(loops.takeEvents(), "contradicts the map"), 1);
  EXPECT_EQ(loops.loopsClosed(), 0U);
  expectSameMap(deceived.map, alone.map);
}

// And the true loop at the end of the round is closed all the same.
TEST(LoopClosing, AfterARefusedLoopATrueOneIsClosed) {
  Landmarks landmarks = twinHall();
  MapTour tour(landmarks, kDrift);
  LoopClosing loops(kLens, {});
  walk(tour, loops, Tour::kRound + 12);
  finish(tour, loops);
  const std::vector<LoopEvent> events = loops.takeEvents();
  EXPECT_GE(countOf(events, "contradicts the map"), 1);
  EXPECT_GE(countOf(events, ""), 1);
  EXPECT_LT(tour.worstPose(), 0.02);
}

TEST(LoopClosing, ALoopThatIsFoundWhileAnotherIsClosedComesNext) {
  LoopClosingOptions options;
  options.detector.cooldown = 0;  // three key frames for the next loop
  options.delay = 0;
  MapTour tour(hall(77, 1500), kDrift);
  LoopClosing loops(kLens, options);
  while (tour.truth.size() + 2 < kFound) {
    tour.step();
    loops.process(tour.map);
    EXPECT_EQ(finish(tour, loops), 0);
  }
  for (int k = 0; k < 6; ++k) {  // both loops are found before the first is closed
    tour.step();
    loops.process(tour.map);
  }
  std::optional<MapCorrection> first = loops.finish(tour.map);
  ASSERT_TRUE(first);
  EXPECT_EQ(loops.loopsClosed(), 1U);
  tour.map.apply(*first);
  std::optional<MapCorrection> second = loops.finish(tour.map);
  ASSERT_TRUE(second);
  EXPECT_EQ(loops.loopsClosed(), 2U);
  tour.map.apply(*second);
  EXPECT_FALSE(loops.finish(tour.map));
  EXPECT_LT(tour.worstPose(), 0.005);
  EXPECT_EQ(countOf(loops.takeEvents(), ""), 2);
}

// Key frames that came after the snapshot move with it.
TEST(LoopClosing, TheMapMayGrowWhileALoopIsClosed) {
  LoopClosingOptions options;
  options.delay = 0;
  MapTour tour(hall(77, 1500), kDrift);
  LoopClosing loops(kLens, options);
  while (tour.truth.size() <= kFound) {
    tour.step();
    loops.process(tour.map);
    if (tour.truth.size() <= kFound) {
      EXPECT_EQ(finish(tour, loops), 0);
    }
  }
  const std::optional<MapCorrection> correction = loops.finish(tour.map);
  ASSERT_TRUE(correction);
  tour.step();
  tour.step();
  tour.map.apply(*correction);
  EXPECT_LT(tour.worstPose(), 0.02);  // two steps of drift, 3 mm each, are new
}

TEST(LoopClosing, AClosureThatThrowsIsOverAndDoneWith) {
  LoopClosingOptions options;
  options.closer.loop_sigma_translation = -1.0;
  MapTour tour(hall(77, 1500), kDrift);
  LoopClosing loops(kLens, options);
  EXPECT_EQ(invalidArgumentOf([&] { walk(tour, loops, kBack + 3); }),
            "options.loop_sigma_translation is -1.000000, expected finite and > 0");
  const std::vector<LoopEvent> events = loops.takeEvents();
  EXPECT_EQ(countOf(events, "closing failed"), 1);
  EXPECT_EQ(countOf(events, ""), 0);
  EXPECT_EQ(loops.loopsClosed(), 0U);
  // The thread goes on: it relocalises, and takes up key frames, and the next loop fails in turn.
  EXPECT_FALSE(loops.finish(tour.map));
  EXPECT_TRUE(loops.relocalize(tour.seenFrom(20), tour.map));
  EXPECT_NE(invalidArgumentOf([&] { walk(tour, loops, kBack + 20); }), "nothing thrown");
}

// Key frames wait in the queue before the question where a lost frame is; one of them throws.
TEST(LoopClosing, WhatAKeyFrameThrewIsNotTheAnswerToARelocalization) {
  LoopClosingOptions options;
  options.detector.verification.radius = -1.0;  // looked at where there is a candidate to verify
  options.delay = 100;
  MapTour tour(hall(77, 1500), kDrift);
  LoopClosing loops(kLens, options);
  while (tour.truth.size() < kFound + 1) {
    tour.step();
    loops.process(tour.map);
    if (tour.truth.size() <= kFound) {
      EXPECT_EQ(finish(tour, loops), 0);
    }
  }
  const auto found = loops.relocalize(tour.seenFrom(20), tour.map);
  ASSERT_TRUE(found);
  EXPECT_LT(metresBetween(*found, tour.map.poseOf(20)), 0.01);
  EXPECT_EQ(invalidArgumentOf([&] { loops.poll(tour.map); }),
            "options.radius is -1.000000, expected finite and > 0");
  EXPECT_FALSE(loops.finish(tour.map));
}

TEST(LoopClosing, EachOfSeveralKeyFramesThatThrewIsHeardOf) {
  LoopClosingOptions options;
  options.detector.verification.radius = -1.0;
  options.delay = 100;
  MapTour tour(hall(77, 1500), kDrift);
  LoopClosing loops(kLens, options);
  while (tour.truth.size() < kFound + 2) {  // the last two find the loop, and throw
    tour.step();
    loops.process(tour.map);
    if (tour.truth.size() <= kFound) {
      EXPECT_EQ(finish(tour, loops), 0);
    }
  }
  EXPECT_TRUE(loops.relocalize(tour.seenFrom(20), tour.map));
  EXPECT_EQ(invalidArgumentOf([&] { loops.poll(tour.map); }),
            "options.radius is -1.000000, expected finite and > 0");
  EXPECT_EQ(invalidArgumentOf([&] { loops.finish(tour.map); }),
            "options.radius is -1.000000, expected finite and > 0");
  EXPECT_FALSE(loops.finish(tour.map));
}

TEST(LoopClosing, ARelocalizationThatThrowsIsOverAndDoneWith) {
  LoopClosingOptions options;
  options.relocalizer.pnp_iterations = 0;
  MapTour tour(hall(77, 1500), kDrift);
  LoopClosing loops(kLens, options);
  walk(tour, loops, 10);
  for (int time = 0; time < 2; ++time) {
    EXPECT_EQ(invalidArgumentOf([&] { loops.relocalize(tour.seenFrom(5), tour.map); }),
              "options.pnp_iterations is 0, expected at least 1");
  }
  walk(tour, loops, 12);
  EXPECT_EQ(finish(tour, loops), 0);
}

TEST(LoopClosing, AStopEndsTheAdjustmentAndTheMapStays) {
  const std::atomic<bool> stop{true};
  LoopClosingOptions options;
  options.closer.bundle.stop = &stop;
  MapTour tour(hall(77, 1500), kDrift);
  LoopClosing loops(kLens, options);
  EXPECT_FALSE(walk(tour, loops, kBack + 3));
  EXPECT_EQ(finish(tour, loops), 0);
  EXPECT_EQ(countOf(loops.takeEvents(), "closing was stopped"), 1);
  MapTour alone(hall(77, 1500), kDrift);
  while (alone.truth.size() < kBack + 3) {
    alone.step();
  }
  expectSameMap(tour.map, alone.map);
}

TEST(LoopClosing, AThreadThatIsFarBehindLeavesKeyFramesOut) {
  LoopClosingOptions options;
  options.delay = 0;
  MapTour tour(hall(77, 1500), {});
  LoopClosing loops(kLens, options);
  for (int k = 0; k < 12; ++k) {
    tour.step();
    loops.process(tour.map);  // results wait, and count as work that is not done
  }
  EXPECT_EQ(loops.keyFramesLeftOut(), 4U);
  EXPECT_EQ(finish(tour, loops), 0);
  tour.step();
  loops.process(tour.map);
  EXPECT_EQ(loops.keyFramesLeftOut(), 4U);
}

TEST(LoopClosing, ALostFrameIsFoundInTheMapAsItIsNow) {
  MapTour tour(hall(77, 1500), kDrift);
  LoopClosing loops(kLens, {});
  walk(tour, loops, kBack + 5);
  finish(tour, loops);
  ASSERT_EQ(loops.loopsClosed(), 1U);
  // The thread knows key frame 40 as it was before the correction.
  const auto found = loops.relocalize(tour.seenFrom(40), tour.map);
  ASSERT_TRUE(found);
  EXPECT_LT(metresBetween(*found, tour.truth[40]), 0.01);
}

TEST(LoopClosing, AFrameFromElsewhereIsNotFound) {
  MapTour tour(hall(77, 1500), {});
  const MapTour elsewhere(hall(79, 1500), {});
  LoopClosing loops(kLens, {});
  walk(tour, loops, 20);
  EXPECT_FALSE(loops.relocalize(elsewhere.seenFrom(5), tour.map));
  EXPECT_FALSE(loops.relocalize(Frame{}, tour.map));
  EXPECT_TRUE(loops.relocalize(tour.seenFrom(5), tour.map));
}

TEST(LoopClosing, SwitchedOffItDoesNothing) {
  LoopClosingOptions options;
  options.enabled = false;
  MapTour tour(hall(77, 1500), kDrift);
  LoopClosing loops(kLens, options);
  EXPECT_FALSE(walk(tour, loops, kBack + 5));
  EXPECT_TRUE(loops.takeEvents().empty());
  EXPECT_FALSE(loops.relocalize(tour.seenFrom(5), tour.map));
}

}  // namespace
}  // namespace hmcdyn::slam

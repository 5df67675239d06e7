// SPDX-License-Identifier: BSD-3-Clause
#include "slam/loop/map_snapshot.hpp"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "loop/map_tour.hpp"

namespace hmcdyn::slam {
namespace {

using namespace hmcdyn::slam::test;  // NOLINT(google-build-using-namespace): the scene's words

const Drift kDrift{{0.0, 0.002, 0.0005}, {0.003, 0.001, 0.0}};

/// Twelve key frames of a slow camera, of which those in the middle were superfluous.
MapTour culledTour() {
  MapTour tour(hall(80, 1500), kDrift);
  for (int k = 0; k < 12; ++k) {
    tour.step();
  }
  MapOptions greedy;
  greedy.superfluous_share = 0.5;
  greedy.superfluous_observers = 2;
  Map copy(kLens, greedy);
  for (const KeyFrame& key_frame : tour.map.keyFrames()) {
    Frame frame = key_frame.frame;
    for (int& point : frame.map_point) {  // numbers are given in the same order again
      point = point < static_cast<int>(copy.points().size()) ? point : kNoMapPoint;
    }
    copy.insertKeyFrame(std::move(frame));
  }
  copy.cull();
  tour.map = std::move(copy);
  return tour;
}

int culledOf(const Map& map) {
  for (std::size_t k = 0; k < map.keyFrames().size(); ++k) {
    if (map.keyFrames()[k].removed) {
      return static_cast<int>(k);
    }
  }
  return -1;
}

LoopConstraint exactLoop(const Map& map, int from, int to) {
  LoopConstraint loop;
  loop.from = static_cast<std::size_t>(from);
  loop.to = static_cast<std::size_t>(to);
  loop.to_from = map.poseOf(to) * map.poseOf(from).inverse();
  loop.key_points = {{1, 2}};
  loop.map_points = {{3, 4}};
  return loop;
}

TEST(LoopKeyFrameOfFrame, HoldsWhatIsBackgroundOnly) {
  const Landmarks landmarks = hall(80, 1500);
  Frame frame = frameOf(see(landmarks, 3, onTour(0)));
  const std::size_t n = frame.points.size();
  ASSERT_GT(n, 20U);
  frame.in_person[0] = 1;                   // a person who stands still
  frame.label[1] = PointLabel::kDynamic;    // moves
  frame.label[2] = PointLabel::kSuspect;    // nobody knows
  frame.label[3] = PointLabel::kUnmatched;  // nor here
  frame.in_person[4] = 1;                   // but the map knows the point
  frame.map_point[4] = 77;
  const LoopKeyFrame copy = makeLoopKeyFrame(frame);
  EXPECT_EQ(copy.points.size(), n - 4);
  EXPECT_EQ(copy.points.u[0], frame.points.u[4]);
  EXPECT_EQ(copy.map_point[0], 77);
  EXPECT_EQ(copy.points.depth[1], frame.points.depth[5]);
  EXPECT_EQ(cv::norm(copy.descriptors.row(1), frame.features.descriptors.row(5), cv::NORM_HAMMING),
            0.0);
  // A copy of its own: the tracker may do with its frame as it likes.
  frame.features.descriptors.setTo(cv::Scalar(0));
  EXPECT_GT(cv::countNonZero(copy.descriptors.row(1)), 0);
  EXPECT_NO_THROW(checkLoopKeyFrame(copy, "copy"));
}

TEST(LoopKeyFrameOfFrame, AnEmptyFrameGivesAnEmptyOne) {
  const LoopKeyFrame copy = makeLoopKeyFrame(Frame{});
  EXPECT_EQ(copy.points.size(), 0U);
  EXPECT_NO_THROW(checkLoopKeyFrame(copy, "copy"));
}

TEST(LoopSnapshotOfMap, HoldsKeyFramesPointsAndTrustedSightings) {
  MapTour tour(hall(80, 1500), kDrift);
  for (int k = 0; k < 5; ++k) {
    tour.step();
  }
  // One point loses its trust, but stays.
  while (tour.map.points()[0].trust.log_odds >= tour.map.options().trust.threshold) {
    tour.map.count(0, true, {PointLabel::kDynamic, 0.0f, true});
  }
  const LoopSnapshot snapshot = toSnapshot(MapCopier().copy(tour.map, {}));
  ASSERT_EQ(snapshot.key_frames.size(), 5U);
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_EQ(snapshot.key_frames[k].id, k);
    EXPECT_EQ(snapshot.key_frames[k].camera_from_world.matrix(),
              tour.map.poseOf(static_cast<int>(k)).matrix());
  }
  ASSERT_EQ(snapshot.points.size(), tour.map.points().size());
  std::size_t sightings = 0;
  for (std::size_t i = 1; i < tour.map.points().size(); ++i) {
    sightings += tour.map.points()[i].observations.size();
  }
  EXPECT_EQ(snapshot.sightings.size(), sightings);
  for (const auto& sighting : snapshot.sightings) {
    EXPECT_NE(sighting.point, 0);
  }
  for (const auto& point : snapshot.points) {
    EXPECT_EQ(static_cast<int>(point.anchor),
              tour.map.points()[static_cast<std::size_t>(point.id)].first_key_frame);
  }
}

// By counting common map points of each pair of key frames.
TEST(LoopSnapshotOfMap, CovisibilityIsTheNumberOfCommonPoints) {
  MapTour tour(hall(80, 1500), kDrift);
  for (int k = 0; k < 6; ++k) {
    tour.step();
  }
  const LoopSnapshot snapshot = toSnapshot(MapCopier().copy(tour.map, {}));
  EXPECT_EQ(snapshot.covisibility.size(), 15U);
  for (const auto& pair : snapshot.covisibility) {
    EXPECT_LT(pair.a, pair.b);
    const auto& of_a = tour.map.keyFrames()[pair.a].frame.map_point;
    const std::set<int> points(of_a.begin(), of_a.end());
    const auto& of_b = tour.map.keyFrames()[pair.b].frame.map_point;
    EXPECT_EQ(pair.weight, std::count_if(of_b.begin(), of_b.end(), [&](int point) {
                return point != kNoMapPoint && points.count(point) != 0;
              }));
  }
}

// By the map's own lists of observations, the other way round.
TEST(LoopSnapshotOfMap, SightingsAreTheMapsObservations) {
  MapTour tour(hall(80, 1500), kDrift);
  for (int k = 0; k < 6; ++k) {
    tour.step();
  }
  const LoopSnapshot snapshot = toSnapshot(MapCopier().copy(tour.map, {}));
  std::size_t next = 0;
  for (std::size_t i = 0; i < tour.map.points().size(); ++i) {
    for (const Observation& seen : tour.map.points()[i].observations) {
      const auto& sighting = snapshot.sightings.at(next++);
      const Frame& frame = tour.map.keyFrames()[static_cast<std::size_t>(seen.key_frame)].frame;
      EXPECT_EQ(sighting.point, static_cast<int>(i));
      EXPECT_EQ(static_cast<int>(sighting.key_frame), seen.key_frame);
      EXPECT_EQ(sighting.u, frame.points.u[seen.key_point]);
      EXPECT_EQ(sighting.v, frame.points.v[seen.key_point]);
      EXPECT_EQ(sighting.depth, frame.points.depth[seen.key_point]);
      EXPECT_EQ(sighting.sigma, frame.sigma[seen.key_point]);
      EXPECT_EQ(sighting.weight, frame.weight[seen.key_point]);
    }
  }
  EXPECT_EQ(next, snapshot.sightings.size());
}

TEST(MapCopier, ACopyStaysAsItIsWhenTheMapGoesOn) {
  MapTour tour(hall(80, 1500), kDrift);
  MapCopier copier;
  for (int k = 0; k < 5; ++k) {
    tour.step();
    copier.remember(tour.map);
  }
  const MapCopy copy = copier.copy(tour.map, {});
  const Eigen::Vector3d first_point = tour.map.points()[0].position;
  tour.step();
  MapCorrection moved;
  moved.key_frames = {{0, onTour(3)}};
  moved.points = {{0, {9.0, 9.0, 9.0}}};
  tour.map.apply(moved);
  EXPECT_EQ(copy.key_frames.size(), 5U);
  EXPECT_EQ(copy.key_frames[0].camera_from_world.matrix(), onTour(0).matrix());
  EXPECT_EQ(copy.point_position[0], first_point);
  // The next one has what is new, and shares what is not.
  const MapCopy next = copier.copy(tour.map, {});
  ASSERT_EQ(next.key_frames.size(), 6U);
  EXPECT_EQ(next.point_position[0], Eigen::Vector3d(9.0, 9.0, 9.0));
  EXPECT_EQ(next.key_frames[2].seen, copy.key_frames[2].seen);
  ASSERT_NE(next.key_frames[5].seen, nullptr);
  EXPECT_EQ(next.key_frames[5].seen->points.u, tour.map.keyFrames()[5].frame.points.u);
}

TEST(MapCopier, WhatCulledKeyFramesSawIsLetGo) {
  MapTour tour(hall(80, 1500), kDrift);
  MapCopier copier;
  for (int k = 0; k < 12; ++k) {
    tour.step();
    copier.remember(tour.map);
  }
  const MapTour culled = culledTour();  // the same key frames
  const int gone = culledOf(culled.map);
  std::weak_ptr<const KeyFrameSightings> seen =
      copier.copy(tour.map, {}).key_frames[static_cast<std::size_t>(gone)].seen;
  ASSERT_FALSE(seen.expired());
  copier.copy(culled.map, {});
  EXPECT_TRUE(seen.expired());
}

TEST(LoopSnapshotOfMap, CulledKeyFramesAreNotInIt) {
  const MapTour tour = culledTour();
  std::size_t culled = 0;
  for (const KeyFrame& key_frame : tour.map.keyFrames()) {
    culled += key_frame.removed ? 1 : 0;
  }
  ASSERT_GT(culled, 0U);
  const LoopSnapshot snapshot = toSnapshot(MapCopier().copy(tour.map, {}));
  EXPECT_EQ(snapshot.key_frames.size(), 12 - culled);
  EXPECT_NO_THROW(closeLoops(snapshot));  // no id is unknown
}

TEST(SurvivingLoop, BetweenKeyFramesThatStandItIsAsItWas) {
  const MapTour tour = culledTour();
  const LoopConstraint loop = exactLoop(tour.map, 0, 11);
  const std::optional<LoopConstraint> surviving = survivingLoop(tour.map, loop);
  ASSERT_TRUE(surviving);
  EXPECT_EQ(surviving->from, 0U);
  EXPECT_EQ(surviving->to, 11U);
  EXPECT_LT((surviving->to_from.matrix() - loop.to_from.matrix()).norm(), 1e-12);
  EXPECT_LT((surviving->information - loop.information).norm(), 1e-12);
  EXPECT_EQ(surviving->key_points, loop.key_points);
}

TEST(SurvivingLoop, ACulledEndHangsOnAnother) {
  const MapTour tour = culledTour();
  const int culled = culledOf(tour.map);
  ASSERT_GE(culled, 0);
  const int anchor = tour.map.survivorOf(culled);
  ASSERT_NE(anchor, culled);
  const int other = anchor == 0 ? 11 : 0;
  for (const bool at_to : {false, true}) {
    const LoopConstraint loop =
        at_to ? exactLoop(tour.map, other, culled) : exactLoop(tour.map, culled, other);
    const std::optional<LoopConstraint> surviving = survivingLoop(tour.map, loop);
    ASSERT_TRUE(surviving);
    EXPECT_EQ(static_cast<int>(at_to ? surviving->to : surviving->from), anchor);
    const LoopConstraint expected =
        at_to ? exactLoop(tour.map, other, anchor) : exactLoop(tour.map, anchor, other);
    EXPECT_LT((surviving->to_from.matrix() - expected.to_from.matrix()).norm(), 1e-9);
    EXPECT_EQ(surviving->map_points, loop.map_points);
    EXPECT_TRUE(surviving->key_points.empty());
  }
}

// The same small error of the world weighs the same, told between either pair.
TEST(SurvivingLoop, TheInformationIsThatOfTheOtherFrame) {
  const MapTour tour = culledTour();
  const int culled = culledOf(tour.map);
  const int other = tour.map.survivorOf(culled) == 0 ? 11 : 0;
  LoopConstraint loop = exactLoop(tour.map, other, culled);
  loop.information.diagonal() << 1.0, 2.0, 3.0, 40.0, 50.0, 60.0;
  loop.information(0, 4) = loop.information(4, 0) = 3.0;
  const std::optional<LoopConstraint> surviving = survivingLoop(tour.map, loop);
  ASSERT_TRUE(surviving);
  const Eigen::Isometry3d to_survivor =
      tour.map.poseOf(culled) * tour.map.poseOf(tour.map.survivorOf(culled)).inverse();
  const auto weight = [](const Eigen::Isometry3d& error, const Eigen::Matrix<double, 6, 6>& info) {
    const Eigen::AngleAxisd turn(error.linear());
    Eigen::Matrix<double, 6, 1> delta;
    delta << turn.angle() * turn.axis(), error.translation();
    return delta.dot(info * delta);
  };
  const Eigen::Isometry3d error = motionOf({2e-5, -1e-5, 3e-5}, {-1e-5, 4e-5, 2e-5});
  const double expected = weight(error, loop.information);
  const double found = weight(to_survivor.inverse() * error * to_survivor, surviving->information);
  EXPECT_NEAR(found / expected, 1.0, 1e-3);
}

TEST(SurvivingLoop, OfOneKeyFrameThereIsNone) {
  const MapTour tour = culledTour();
  const int culled = culledOf(tour.map);
  EXPECT_FALSE(survivingLoop(tour.map, exactLoop(tour.map, culled, tour.map.survivorOf(culled))));
}

TEST(CorrectionOfClosure, NamesPosesPointsFusionsAndOutliers) {
  LoopSnapshot snapshot;
  snapshot.sightings = {{3, 7}, {4, 7}, {4, 8}};
  snapshot.sightings[2].weight = 0.0f;  // took no part
  LoopClosure closure;
  closure.key_frames = {{3, onTour(1)}, {4, onTour(2)}};
  closure.points = {{7, {1.0, 2.0, 3.0}, 7}, {8, {1.0, 2.0, 3.0}, 7}};
  closure.inlier = {1, 0, 0};
  closure.bundle.rounds = 1;
  closure.bundle.used = 2;
  closure.bundle.inliers = 1;
  closure.bundle.termination = BundleTermination::kConverged;
  const MapCorrection correction = toCorrection(snapshot, closure);
  ASSERT_EQ(correction.key_frames.size(), 2U);
  EXPECT_EQ(correction.key_frames[1].first, 4);
  EXPECT_EQ(correction.key_frames[1].second.matrix(), onTour(2).matrix());
  ASSERT_EQ(correction.points.size(), 2U);
  EXPECT_EQ(correction.fused, (std::vector<std::pair<int, int>>{{8, 7}}));
  EXPECT_EQ(correction.outliers, (std::vector<std::pair<int, int>>{{7, 4}}));
}

}  // namespace
}  // namespace hmcdyn::slam

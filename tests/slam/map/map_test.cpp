// SPDX-License-Identifier: BSD-3-Clause
#include "slam/map/map.hpp"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "slam/run/trajectory_log.hpp"
#include "track/room.hpp"

namespace hmcdyn::slam {
namespace {

class MapTest : public testing::Test {
 protected:
  MapTest() : room_(11, 200), map_(kCamera, options()) {}

  /// A few key frames are enough to make others superfluous.
  static MapOptions options() {
    MapOptions options;
    options.superfluous_observers = 3;
    return options;
  }

  Frame see(std::size_t index, double x) const {
    Frame frame = room_.see(index, movedBy(x, 0.0));
    frame.camera_from_world = movedBy(x, 0.0);
    return frame;
  }
  /// Key frames that all see the same points.
  void insert(int count) {
    for (int k = 0; k < count; ++k) {
      Frame frame = see(static_cast<std::size_t>(k), 0.0);
      map_.insertKeyFrame(k == 0 ? frame : tied(std::move(frame), map_));
    }
  }

  Room room_;
  Map map_;
};

TEST_F(MapTest, CovisibleKeyFramesAreCountedAndSortedByWhatTheyShare) {
  insert(2);
  map_.insertKeyFrame(see(2, 0.0));  // untied: points of its own
  Frame half = tied(see(3, 0.0), map_);
  for (std::size_t i = 0; i < half.map_point.size(); i += 2) {
    half.map_point[i] = map_.keyFrames()[2].frame.map_point[i];
  }
  map_.insertKeyFrame(half);
  const std::size_t points = half.map_point.size();
  const std::vector<std::pair<int, int>> covisible = map_.covisible(3);
  ASSERT_EQ(covisible.size(), 3U);
  int shared_with_2 = 0;
  for (const auto& [key_frame, shared] : covisible) {
    shared_with_2 = key_frame == 2 ? shared : shared_with_2;
  }
  EXPECT_EQ(static_cast<std::size_t>(shared_with_2), (points + 1) / 2);
  EXPECT_GE(covisible[0].second, covisible[1].second);
  EXPECT_GE(covisible[1].second, covisible[2].second);
}

TEST_F(MapTest, ASuperfluousKeyFrameGoesAndKeepsItsPlaceInTheTrajectory) {
  // Given eight key frames that all see the same, and a frame that hangs on the second
  insert(8);
  TrajectoryLog log;
  log.add(1.0, movedBy(0.25, 0.0), 1, map_);
  // When the map is culled
  map_.cull();
  // Then the middle ones go, the first and the latest three stay, and poses are as before.
  EXPECT_FALSE(map_.keyFrames().front().removed);
  EXPECT_TRUE(map_.keyFrames()[1].removed);
  for (std::size_t k = 5; k < 8; ++k) {
    EXPECT_FALSE(map_.keyFrames()[k].removed) << k;
  }
  EXPECT_TRUE(map_.keyFrames()[1].frame.features.key_points.empty()) << "its memory is given back";
  EXPECT_LT(distanceBetween(map_.poseOf(1), movedBy(0.0, 0.0)), 1e-9);
  EXPECT_LT(distanceBetween(log.poses(map_).front().camera_from_world, movedBy(0.25, 0.0)), 1e-9);
  // And when what it hangs on is moved, the frame moves along.
  MapCorrection correction;
  for (int k = 0; k < 8; ++k) {
    if (!map_.keyFrames()[static_cast<std::size_t>(k)].removed) {
      correction.key_frames.emplace_back(k, movedBy(0.1, 0.0));
    }
  }
  map_.apply(correction);
  EXPECT_LT(distanceBetween(log.poses(map_).front().camera_from_world, movedBy(0.35, 0.0)), 1e-9);
}

TEST_F(MapTest, WhatCameAfterASnapshotMovesWithItsLatestKeyFrame) {
  insert(2);
  map_.insertKeyFrame(see(2, 0.1));  // new points of its own
  const int new_point = map_.keyFrames()[2].frame.map_point.front();
  const Eigen::Vector3d before = map_.points()[static_cast<std::size_t>(new_point)].position;
  MapCorrection correction;
  correction.key_frames = {{1, movedBy(0.05, 0.0)}};  // the world slides by 5 cm
  map_.apply(correction);
  EXPECT_LT(distanceBetween(map_.poseOf(2), movedBy(0.15, 0.0)), 1e-9);
  const Eigen::Vector3d after = map_.points()[static_cast<std::size_t>(new_point)].position;
  EXPECT_NEAR((after - before - Eigen::Vector3d(0.05, 0.0, 0.0)).norm(), 0.0, 1e-9);
}

TEST_F(MapTest, OutliersAreDroppedAndPointsFusedOnBothSides) {
  insert(2);
  map_.insertKeyFrame(see(2, 0.0));
  const int kept = map_.keyFrames()[0].frame.map_point[3];
  const int gone = map_.keyFrames()[2].frame.map_point[3];
  MapCorrection correction;
  correction.key_frames = {{2, map_.poseOf(2)}};
  correction.outliers = {{map_.keyFrames()[0].frame.map_point[5], 1}};
  correction.fused = {{gone, kept}};
  map_.apply(correction);
  EXPECT_EQ(map_.keyFrames()[1].frame.map_point[5], kNoMapPoint);
  EXPECT_EQ(map_.keyFrames()[2].frame.map_point[3], kept);
  EXPECT_TRUE(map_.points()[static_cast<std::size_t>(gone)].removed);
  EXPECT_EQ(map_.points()[static_cast<std::size_t>(kept)].observations.size(), 3U);
}

TEST_F(MapTest, ACorrectionThatNamesWhatIsGoneDoesNoHarm) {
  insert(8);
  MapCorrection correction;
  correction.key_frames = {{1, movedBy(0.3, 0.0)}, {7, map_.poseOf(7)}};
  correction.points = {{0, Eigen::Vector3d::Zero()}};
  correction.outliers = {{0, 1}};
  correction.fused = {{0, 0}};
  map_.cull();  // removes key frame 1
  ASSERT_TRUE(map_.keyFrames()[1].removed);
  map_.apply(correction);
  EXPECT_LT(distanceBetween(map_.poseOf(1), movedBy(0.0, 0.0)), 1e-9) << "it hangs on another";
}

TEST_F(MapTest, LocalKeyFramesAreTheLatestAndThoseThatShareMost) {
  MapOptions options;
  options.local_key_frames = 5;
  map_ = Map(kCamera, options);
  insert(12);
  const std::vector<int> local = map_.localKeyFrames(tied(see(12, 0.0), map_));
  EXPECT_EQ(local, (std::vector<int>{11, 10, 9, 8, 0}));
  const std::vector<int> points = map_.pointsOf(local);
  EXPECT_TRUE(std::is_sorted(points.begin(), points.end()));
  EXPECT_EQ(points.size(), map_.points().size());
}

TEST_F(MapTest, NearestKeyFramesLookTheSameWay) {
  for (std::size_t k = 0; k < 4; ++k) {
    map_.insertKeyFrame(see(k, 0.1 * static_cast<double>(k)));
  }
  Frame behind = see(4, 0.0);
  behind.camera_from_world.linear() =
      Eigen::AngleAxisd(3.1, Eigen::Vector3d::UnitY()).toRotationMatrix();
  map_.insertKeyFrame(behind);
  EXPECT_EQ(map_.nearestKeyFrames(movedBy(0.28, 0.0)), (std::vector<int>{3, 2, 1, 0}));
}

}  // namespace
}  // namespace hmcdyn::slam

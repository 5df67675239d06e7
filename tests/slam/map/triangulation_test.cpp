// SPDX-License-Identifier: BSD-3-Clause
#include "slam/map/triangulation.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "track/room.hpp"

namespace hmcdyn::slam {
namespace {

TEST(Midpoint, OfTwoRaysThatMeetIsWhereTheyMeet) {
  const Eigen::Vector3d point(0.3, -0.2, 2.0);
  const Eigen::Vector3d from(0.0, 0.0, 0.0);
  const Eigen::Vector3d to(0.5, 0.1, -0.1);
  const Eigen::Vector3d found =
      midpoint(from, (point - from).normalized(), to, (point - to).normalized());
  EXPECT_LT((found - point).norm(), 1e-12);
}

TEST(Midpoint, OfSkewRaysLiesBetweenTheirNearestPoints) {
  // Along x at z = 1, and along y at z = 3: nearest at (0, 0, 1) and (0, 0, 3).
  const Eigen::Vector3d found = midpoint({-5.0, 0.0, 1.0}, Eigen::Vector3d::UnitX(),
                                         {0.0, -4.0, 3.0}, Eigen::Vector3d::UnitY());
  EXPECT_LT((found - Eigen::Vector3d(0.0, 0.0, 2.0)).norm(), 1e-12);
}

TEST(Midpoint, OfParallelRaysIsNotFinite) {
  EXPECT_FALSE(
      midpoint({0.0, 0.0, 0.0}, Eigen::Vector3d::UnitZ(), {1.0, 0.0, 0.0}, Eigen::Vector3d::UnitZ())
          .allFinite());
}

/// Two key frames of a room 0.3 m apart; every third of their key points has lost its depth.
Map twoViews(const Room& room) {
  Map map(kCamera, {});
  for (std::size_t k = 0; k < 2; ++k) {
    Frame frame = room.see(k, movedBy(0.3 * static_cast<double>(k), 0.0));
    frame.camera_from_world = movedBy(0.3 * static_cast<double>(k), 0.0);
    for (std::size_t i = 0; i < frame.points.size(); ++i) {
      if (frame.features.key_points[i].class_id % 3 == 0) {
        frame.points.depth[i] = 0.0f;
      }
    }
    if (k > 0) {
      frame = tied(std::move(frame), map);
    }
    map.insertKeyFrame(std::move(frame));
  }
  return map;
}

TEST(Triangulation, FindsPointsThatNoDepthTells) {
  const Room room(21);
  const Map map = twoViews(room);
  const auto found = triangulateNewPoints(map, {});
  ASSERT_GT(found.size(), 20U);
  for (const TriangulatedPoint& point : found) {
    const Frame& first = map.keyFrames()[1].frame;
    const Frame& second = map.keyFrames()[0].frame;
    EXPECT_EQ(first.features.key_points[point.first.key_point].class_id,
              second.features.key_points[point.second.key_point].class_id);
    EXPECT_EQ(first.points.depth[point.first.key_point], 0.0f);
    const Eigen::Vector2d seen = kCamera.project(first.camera_from_world * point.position);
    EXPECT_NEAR(seen.x(), first.points.u[point.first.key_point], 0.01);
    EXPECT_GT(point.position.z(), 1.4);
    EXPECT_LT(point.position.z(), 3.1);
  }
}

TEST(Triangulation, PeopleStayOut) {
  const Room room(22);
  Map map(kCamera, {});
  for (std::size_t k = 0; k < 2; ++k) {
    Frame frame = room.see(k, movedBy(0.3 * static_cast<double>(k), 0.0));
    frame.camera_from_world = movedBy(0.3 * static_cast<double>(k), 0.0);
    for (std::size_t i = 0; i < frame.points.size(); ++i) {
      const bool hidden = frame.features.key_points[i].class_id % 3 == 0;
      frame.points.depth[i] = hidden ? 0.0f : frame.points.depth[i];
      frame.in_person[i] = hidden ? 1 : 0;
    }
    map.insertKeyFrame(k > 0 ? tied(std::move(frame), map) : std::move(frame));
  }
  EXPECT_TRUE(triangulateNewPoints(map, {}).empty());
}

TEST(Triangulation, WithoutParallaxNothingIsKnown) {
  const Room room(23);
  Map map(kCamera, {});
  for (std::size_t k = 0; k < 2; ++k) {
    Frame frame = room.see(k, movedBy(0.001 * static_cast<double>(k), 0.0));
    frame.camera_from_world = movedBy(0.001 * static_cast<double>(k), 0.0);
    for (std::size_t i = 0; i < frame.points.size(); ++i) {
      frame.points.depth[i] =
          frame.features.key_points[i].class_id % 3 == 0 ? 0.0f : frame.points.depth[i];
    }
    map.insertKeyFrame(k > 0 ? tied(std::move(frame), map) : std::move(frame));
  }
  EXPECT_TRUE(triangulateNewPoints(map, {}).empty());
}

TEST(Map, ATriangulatedPointIsSeenByBothKeyFrames) {
  const Room room(24);
  Map map = twoViews(room);
  const auto found = triangulateNewPoints(map, {});
  ASSERT_FALSE(found.empty());
  const std::size_t held = map.points().held();
  map.addPoint(found[0].position, found[0].first, found[0].second);
  map.addPoint(found[0].position, found[0].first, found[0].second);  // they have one already
  EXPECT_EQ(map.points().held(), held + 1);
  const int point = map.keyFrames()[1].frame.map_point[found[0].first.key_point];
  EXPECT_EQ(map.keyFrames()[0].frame.map_point[found[0].second.key_point], point);
  EXPECT_EQ(map.points()[static_cast<std::size_t>(point)].observations.size(), 2U);
}

}  // namespace
}  // namespace hmcdyn::slam

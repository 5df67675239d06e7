// SPDX-License-Identifier: BSD-3-Clause
#include "slam/output/dense/dense_map.hpp"

#include <cmath>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "slam/output/dense/room.hpp"

namespace hmcdyn::slam {
namespace {

using test::lookingAlongZ;
using test::smallCamera;
using test::wallAt;

TEST(DenseMap, UsesThePosesOfTheEnd) {
  DenseMap map;
  map.add(3, wallAt(2.0));
  map.add(7, wallAt(2.0));
  const Eigen::Isometry3d corrected = lookingAlongZ(0, 0, 0.5);
  const FusionResult result = map.fuse({{7, corrected}, {3, corrected}}, smallCamera());
  ASSERT_FALSE(result.cloud.position.empty());
  for (const Eigen::Vector3f& point : result.cloud.position) {
    ASSERT_NEAR(point.z(), 2.5f, 1e-5f);
  }
}

TEST(DenseMap, LeavesOutWhatHasNoPoseOrNoImages) {
  DenseMap map;
  map.add(1, wallAt(2.0));
  map.add(2, wallAt(1.0));  // culled later
  const FusionResult result =
      map.fuse({{1, lookingAlongZ(0, 0, 0)}, {9, lookingAlongZ(0, 0, 0)}}, smallCamera());
  ASSERT_FALSE(result.cloud.position.empty());
  for (const Eigen::Vector3f& point : result.cloud.position) {
    ASSERT_NEAR(point.z(), 2.0f, 1e-5f);
  }
  EXPECT_TRUE(map.fuse({}, smallCamera()).cloud.position.empty());
}

TEST(DenseMap, KeepsEvenlySpreadKeyFramesWithinItsCapacity) {
  DenseMap map(4);
  for (std::size_t id = 0; id < 21; ++id) {
    // A wall of its own for each key frame, so that the map shows which are kept.
    map.add(10 * id, wallAt(1.0 + 0.1 * static_cast<double>(id)));
    EXPECT_LE(map.size(), 4U);
  }
  FusionOptions options;
  options.min_sightings = 0;
  options.max_free_share = 1.0;
  std::vector<KeyFramePose> poses;
  for (std::size_t id = 0; id < 21; ++id) {
    poses.push_back({10 * id, lookingAlongZ(0, 0, 0)});
  }
  // 0-3, then 0 2 4 6, then 0 4 8 12, then 0 8 16: 1.0, 1.8 and 2.6 m.
  std::vector<bool> seen(3);
  for (const Eigen::Vector3f& point : map.fuse(poses, smallCamera(), options).cloud.position) {
    const float wall = (point.z() - 1.0f) / 0.8f;
    ASSERT_NEAR(wall, std::round(wall), 1e-4f);
    seen.at(static_cast<std::size_t>(std::lround(wall))) = true;
  }
  EXPECT_EQ(seen, (std::vector<bool>{true, true, true}));
}

TEST(DenseMap, RefusesIdsThatDoNotAscendAndTinyCapacities) {
  EXPECT_THROW(DenseMap(1), std::invalid_argument);
  DenseMap map;
  map.add(5, wallAt(2.0));
  EXPECT_THROW(map.add(5, wallAt(2.0)), std::invalid_argument);
  EXPECT_THROW(map.add(4, wallAt(2.0)), std::invalid_argument);
}

}  // namespace
}  // namespace hmcdyn::slam

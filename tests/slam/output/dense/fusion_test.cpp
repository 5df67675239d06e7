// SPDX-License-Identifier: BSD-3-Clause
#include "slam/output/dense/fusion.hpp"

#include <limits>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "slam/output/dense/room.hpp"

namespace hmcdyn::slam {
namespace {

using test::lookingAlongZ;
using test::pointsOfPerson;
using test::smallCamera;
using test::wallAt;
using test::wallWithPerson;

const cv::Rect kLeft(10, 20, 8, 8);
const cv::Rect kRight(40, 20, 8, 8);

TEST(Fusion, AWallSeenFromTwoPlacesIsOnePlane) {
  const ThinnedKeyFrame far = wallAt(2.0);
  const ThinnedKeyFrame near = wallAt(1.5);
  const FusionResult result = fuseKeyFrames(
      {{&far, lookingAlongZ(0, 0, 0)}, {&near, lookingAlongZ(0.2, 0, 0.5)}}, smallCamera());
  ASSERT_GT(result.cloud.position.size(), 1000U);
  ASSERT_EQ(result.cloud.colour.size(), result.cloud.position.size());
  for (const Eigen::Vector3f& point : result.cloud.position) {
    ASSERT_NEAR(point.z(), 2.0f, 1e-5f);
  }
  EXPECT_EQ(result.cloud.colour.front(), (Colour{10, 20, 30})) << "red first";
  EXPECT_EQ(result.voxels, result.cloud.position.size() + result.rare + result.free);
}

TEST(Fusion, AVoxelHoldsTheWeightedMeanOfItsPoints) {
  // One usable pixel on the optical axis each: depths 2.000 and 2.008 m in one voxel of 2 cm, with
  // weights 1/4 and 1/2.008^2 = 0.2480111: 2.0 + 0.008 * 0.2480111 / 0.4980111 = 2.0039841 m.
  const PinholeCamera camera{60.0, 60.0, 31.0, 23.0};
  ThinnedKeyFrame first = wallAt(2.0, {0, 0, 0});
  ThinnedKeyFrame second = wallAt(2.008, {200, 200, 200});
  for (ThinnedKeyFrame* frame : {&first, &second}) {
    frame->usable.setTo(0);
    frame->usable.at<std::uint8_t>(23, 31) = 255;
  }
  const Eigen::Isometry3d pose = lookingAlongZ(0, 0, 0);
  const FusionResult result = fuseKeyFrames({{&first, pose}, {&second, pose}}, camera);
  ASSERT_EQ(result.cloud.position.size(), 1U);
  EXPECT_NEAR(result.cloud.position[0].z(), 2.0039841f, 1e-6f);
  EXPECT_EQ(result.cloud.colour[0][0], 100) << "200 * 0.2480111 / 0.4980111 = 99.6";
}

TEST(Fusion, APersonWhoWasMissedOnceGoes) {
  const ThinnedKeyFrame empty = wallAt(2.0);
  const ThinnedKeyFrame missed = wallWithPerson(2.0, kLeft, false);
  const Eigen::Isometry3d pose = lookingAlongZ(0, 0, 0);
  const FusionResult result =
      fuseKeyFrames({{&empty, pose}, {&missed, pose}, {&empty, pose}}, smallCamera());
  EXPECT_EQ(pointsOfPerson(result.cloud), 0);
  EXPECT_GT(result.rare, 0U);
}

TEST(Fusion, APersonWhoStoodStillGoesWhenOthersLookThrough) {
  const ThinnedKeyFrame empty = wallAt(2.0);
  const ThinnedKeyFrame standing = wallWithPerson(2.0, kLeft, false);
  const Eigen::Isometry3d pose = lookingAlongZ(0, 0, 0);
  // Seen by two, looked through by two: 0.5 is above 0.3. Without the rule the person stays.
  const std::vector<PosedKeyFrame> frames{
      {&standing, pose}, {&standing, pose}, {&empty, pose}, {&empty, pose}};
  const FusionResult checked = fuseKeyFrames(frames, smallCamera());
  EXPECT_EQ(pointsOfPerson(checked.cloud), 0);
  EXPECT_GT(checked.free, 0U);
  FusionOptions lenient;
  lenient.max_free_share = 1.0;
  EXPECT_GT(pointsOfPerson(fuseKeyFrames(frames, smallCamera(), lenient).cloud), 0);
}

TEST(Fusion, AMaskedPersonMakesNoPointAndHidesNoWall) {
  const ThinnedKeyFrame left = wallWithPerson(2.0, kLeft, true);
  const ThinnedKeyFrame right = wallWithPerson(2.0, kRight, true);
  const Eigen::Isometry3d pose = lookingAlongZ(0, 0, 0);
  FusionOptions one;
  one.min_sightings = 1;
  const FusionResult result = fuseKeyFrames({{&left, pose}, {&right, pose}}, smallCamera(), one);
  EXPECT_EQ(pointsOfPerson(result.cloud), 0);
  EXPECT_EQ(result.free, 0U);
  const ThinnedKeyFrame empty = wallAt(2.0);
  EXPECT_EQ(result.cloud.position.size(),
            fuseKeyFrames({{&empty, pose}}, smallCamera()).cloud.position.size())
      << "each sees what the other's person hides";
}

TEST(Fusion, APersonInFrontDoesNotCarveTheWallBehind) {
  // Three of four key frames have a person before the wall: they know nothing of the wall there.
  const ThinnedKeyFrame person = wallWithPerson(2.0, kLeft, true);
  const ThinnedKeyFrame empty = wallAt(2.0);
  const Eigen::Isometry3d pose = lookingAlongZ(0, 0, 0);
  FusionOptions one;
  one.min_sightings = 1;
  const FusionResult result = fuseKeyFrames(
      {{&person, pose}, {&person, pose}, {&person, pose}, {&empty, pose}}, smallCamera(), one);
  EXPECT_EQ(result.free + result.rare, 0U);
}

TEST(Fusion, OneKeyFrameIsAMapAndNoneIsEmpty) {
  const ThinnedKeyFrame wall = wallAt(2.0);
  EXPECT_GT(fuseKeyFrames({{&wall, lookingAlongZ(0, 0, 0)}}, smallCamera()).cloud.position.size(),
            1000U);
  EXPECT_EQ(fuseKeyFrames({}, smallCamera()).cloud.position.size(), 0U);
}

TEST(Fusion, APoseThatIsNotFiniteIsLeftOut) {
  const ThinnedKeyFrame wall = wallAt(2.0);
  Eigen::Isometry3d lost = lookingAlongZ(0, 0, 0);
  lost.translation().x() = std::numeric_limits<double>::quiet_NaN();
  const FusionResult result =
      fuseKeyFrames({{&wall, lost}, {&wall, lookingAlongZ(0, 0, 0)}}, smallCamera());
  EXPECT_EQ(result.rare, 0U) << "one key frame counts, so one sighting is enough";
  EXPECT_GT(result.cloud.position.size(), 1000U);
}

TEST(Fusion, MemoryIsBounded) {
  const ThinnedKeyFrame wall = wallAt(2.0);
  FusionOptions few;
  few.max_voxels = 100;
  const FusionResult result = fuseKeyFrames({{&wall, lookingAlongZ(0, 0, 0)}}, smallCamera(), few);
  EXPECT_TRUE(result.is_truncated);
  EXPECT_EQ(result.voxels, 100U);
}

TEST(Fusion, GivesTheSameBytesEachTime) {
  const ThinnedKeyFrame a = wallWithPerson(2.0, kLeft, true);
  const ThinnedKeyFrame b = wallWithPerson(1.5, kRight, true);
  const std::vector<PosedKeyFrame> frames{{&a, lookingAlongZ(0, 0, 0)},
                                          {&b, lookingAlongZ(0.1, 0, 0.5)}};
  const FusionResult first = fuseKeyFrames(frames, smallCamera());
  const FusionResult second = fuseKeyFrames(frames, smallCamera());
  EXPECT_EQ(first.cloud.position, second.cloud.position);
  EXPECT_EQ(first.cloud.colour, second.cloud.colour);
}

TEST(Fusion, RefusesOptionsOutOfRange) {
  FusionOptions options;
  options.voxel_size = 0.0;
  EXPECT_THROW(fuseKeyFrames({}, smallCamera(), options), std::invalid_argument);
  options = {};
  options.max_free_share = 1.5;
  EXPECT_THROW(fuseKeyFrames({}, smallCamera(), options), std::invalid_argument);
  EXPECT_THROW(fuseKeyFrames({{nullptr, lookingAlongZ(0, 0, 0)}}, smallCamera()),
               std::invalid_argument);
}

}  // namespace
}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "synthesize/renderer.hpp"
#include "synthesize/scene_catalog.hpp"
#include "synthesize/sequence.hpp"

namespace hmcdyn::synthesize {
namespace {

const std::vector<std::string> kNames{"walking_xyz",
                                      "walking_halfsphere",
                                      "walking_rpy",
                                      "walking_static",
                                      "sitting_halfsphere",
                                      "sitting_static",
                                      "crowd",
                                      "crowd2",
                                      "crowd3",
                                      "synchronous2",
                                      "half",
                                      "xyz",
                                      "tri",
                                      "front",
                                      "static",
                                      "along_line",
                                      "occluder",
                                      "late_start",
                                      "still_camera",
                                      "pure_rotation",
                                      "low_texture",
                                      "empty",
                                      "round",
                                      "walking_round",
                                      "balloon",
                                      "carried_box",
                                      "trolley",
                                      "opening_door",
                                      "moved_chair",
                                      "robot_vacuum"};

SceneOptions quick(double seconds = 10.0) {
  SceneOptions options;
  options.seconds = seconds;
  options.threads = 2;
  options.max_texture = 256;
  return options;
}

RenderOptions thumbnail() {
  RenderOptions options;
  options.width = 80;
  options.height = 60;
  options.camera = scaledCamera(80, 60);
  return options;
}

/// A scene for depth and masks, which do not ask how it is painted: grey.
BuiltScene grey(const std::string& name) {
  SceneOptions options = quick();
  options.paint = false;
  BuiltScene built = buildScene(name, options);
  TextureLibrary plain;
  for (std::size_t i = 0; i < built.scene.textures.size(); ++i) {
    plain.add([] { return cv::Mat(8, 8, CV_8UC3, cv::Scalar::all(128)); });
  }
  plain.paint(1, 8);
  built.scene.textures = std::move(plain);
  return built;
}

struct Motion {
  double speed = 0.0;  ///< Mean (m/s).
  double rate = 0.0;   ///< Mean (deg/s).
};

Motion motionOf(const CameraPath& camera, double seconds) {
  Motion motion;
  const int steps = static_cast<int>(seconds * 30.0);
  for (int i = 0; i < steps; ++i) {
    const Eigen::Isometry3d step = camera(i / 30.0).inverse() * camera((i + 1) / 30.0);
    motion.speed += step.translation().norm() / seconds;
    motion.rate += Eigen::AngleAxisd(step.linear()).angle() * 57.29578 / seconds;
  }
  return motion;
}

TEST(SceneCatalog, HasEverySceneWithADescription) {
  std::vector<std::string> names;
  for (const SceneInfo& info : sceneCatalog()) {
    names.push_back(info.name);
    EXPECT_FALSE(info.description.empty()) << info.name;
  }
  EXPECT_EQ(names, kNames);
}

TEST(SceneCatalog, UnknownNameListsTheKnownOnes) {
  try {
    buildScene("walking_zyx", quick());
    FAIL() << "expected std::invalid_argument";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("walking_xyz"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("'walking_zyx'"), std::string::npos);
  }
}

class EveryScene : public testing::TestWithParam<std::string> {};

/// Painting takes nearly all of the time, and scenes of one seed share their pictures: these have
/// the three rooms, what hides people, and all eight people.
bool showsNewPictures(const std::string& name) {
  return name == "crowd3" || name == "occluder" || name == "low_texture";
}

TEST_P(EveryScene, FillsTheImageAndKeepsTheCameraInTheRoomAwayFromWhatMoves) {
  const BuiltScene built =
      showsNewPictures(GetParam()) ? buildScene(GetParam(), quick()) : grey(GetParam());
  Renderer renderer(built.scene, thumbnail());
  const bool has_person = std::any_of(built.scene.movers.begin(), built.scene.movers.end(),
                                      [](const Mover& mover) { return mover.is_person; });
  bool mover_seen = built.scene.movers.empty();
  for (int i = 0; i < 5; ++i) {
    const RenderedFrame frame = renderer.render(2.4 * i);
    EXPECT_EQ(cv::countNonZero(frame.depth == 0.0f), 0) << "frame " << i;
    mover_seen = mover_seen || cv::countNonZero(frame.mask) > (has_person ? 200 : 20);
  }
  EXPECT_TRUE(mover_seen);
  for (double time = 0.0; time < 10.0; time += 0.1) {
    const Eigen::Vector3d eye = built.scene.camera(time).translation();
    ASSERT_TRUE(built.bounds.contains(eye)) << eye.transpose();
    for (const Mover& mover : built.scene.movers) {
      // a person's head, or where a thing has its origin
      const Eigen::Vector3d middle = mover.poses(time)[mover.is_person ? 2 : 0].translation();
      ASSERT_TRUE(built.bounds.contains(middle)) << "at " << middle.transpose();
      ASSERT_GT((middle - eye).head<2>().norm(), 0.45) << "at " << time << " s";
    }
  }
}

TEST_P(EveryScene, CameraMovesAtTheSpeedsOfTheTumSequences) {
  const std::string name = GetParam();
  SceneOptions options = quick();
  options.paint = false;
  const Motion motion = motionOf(buildScene(name, options).scene.camera, 10.0);
  if (name == "still_camera") {
    EXPECT_EQ(motion.speed, 0.0);
    EXPECT_EQ(motion.rate, 0.0);
  } else if (name == "pure_rotation") {
    EXPECT_EQ(motion.speed, 0.0);
    EXPECT_GT(motion.rate, 8.0);
    EXPECT_LT(motion.rate, 40.0);
  } else if (name.find("static") != std::string::npos) {
    EXPECT_LT(motion.speed, 0.03);
    EXPECT_LT(motion.rate, 3.0);
  } else if (name == "walking_rpy") {
    EXPECT_LT(motion.speed, 0.1);
    EXPECT_GT(motion.rate, 10.0);
    EXPECT_LT(motion.rate, 40.0);
  } else {
    EXPECT_GT(motion.speed, 0.1);
    EXPECT_LT(motion.speed, 0.4);
    EXPECT_LT(motion.rate, 40.0);
  }
}

INSTANTIATE_TEST_SUITE_P(All, EveryScene, testing::ValuesIn(kNames),
                         [](const auto& instance) { return instance.param; });

double personShare(const RenderedFrame& frame) {
  return static_cast<double>(cv::countNonZero(frame.mask)) /
         static_cast<double>(frame.mask.total());
}

TEST(SceneCatalog, CrowdsCoverFortyPercentOfTheImageForSeconds) {
  for (const char* name : {"crowd", "crowd2", "crowd3"}) {
    const BuiltScene built = grey(name);
    Renderer renderer(built.scene, thumbnail());
    int covered = 0;
    for (int i = 0; i < 50; ++i) {
      covered += personShare(renderer.render(0.2 * i)) >= 0.4 ? 1 : 0;
    }
    EXPECT_GE(covered, 10) << name << ": fifths of a second";
  }
}

TEST(SceneCatalog, TheRoundComesBackToWhereItBegan) {
  SceneOptions options = quick();
  options.paint = false;
  for (const char* name : {"round", "walking_round"}) {
    const CameraPath camera = buildScene(name, options).scene.camera;
    const auto apart = [&](double time) {
      const Eigen::Isometry3d way = camera(0.0).inverse() * camera(time);
      return std::pair(way.translation().norm(), Eigen::AngleAxisd(way.linear()).angle());
    };
    // A hand of 4 mm and 0.0045 rad an axis, and the height, whose swings do not end with the
    // round.
    EXPECT_LT(apart(14.0).first, 0.1);
    EXPECT_LT(apart(14.0).second, 0.04);
    EXPECT_GT(apart(7.0).first, 1.3) << "the other side of the circle";
    EXPECT_GT(apart(7.0).second, 2.8) << "and the other way";
  }
}

TEST(SceneCatalog, NobodyIsInTheEmptyScene) {
  SceneOptions options = quick();
  options.paint = false;
  EXPECT_TRUE(buildScene("empty", options).scene.movers.empty());
}

TEST(SceneCatalog, PeopleOfLateStartStandStillBeforeTheyWalk) {
  const BuiltScene built = grey("late_start");
  Renderer renderer(built.scene, thumbnail());
  const RenderedFrame early = renderer.render(3.0);
  const RenderedFrame late = renderer.render(8.5);
  EXPECT_GT(cv::countNonZero(early.mask == kMaskStanding), 200);
  EXPECT_EQ(cv::countNonZero(early.mask == kMaskMoving), 0);
  EXPECT_GT(cv::countNonZero(late.mask == kMaskMoving), 100);
}

TEST(SceneCatalog, PeopleOfSynchronous2StepTogether) {
  SceneOptions options = quick();
  options.paint = false;
  const BuiltScene built = buildScene("synchronous2", options);
  ASSERT_EQ(built.scene.movers.size(), 2U);
  for (double time = 0.0; time < 9.0; time += 0.5) {
    const Eigen::Vector3d first = built.scene.movers[0].poses(time)[0].translation();
    const Eigen::Vector3d second = built.scene.movers[1].poses(time)[0].translation();
    EXPECT_NEAR(first.x(), second.x(), 0.02) << "at " << time << " s";
  }
}

/// Pixels of a mover with a value in the mask.
int pixelsOf(const RenderedFrame& frame, int mover, std::uint8_t value) {
  return cv::countNonZero((frame.mover == mover) & (frame.mask == static_cast<int>(value)));
}

TEST(SceneCatalog, WhatSomebodyMovesStandsFirstMovesAndStandsWhereItWasLeft) {
  for (const char* name : {"carried_box", "moved_chair", "trolley"}) {
    const BuiltScene built = grey(name);
    constexpr int kThing = 1;  // after the person
    ASSERT_EQ(built.scene.movers.size(), 2U) << name;
    ASSERT_FALSE(built.scene.movers[kThing].is_person) << name;
    Renderer renderer(built.scene, thumbnail());
    EXPECT_EQ(pixelsOf(renderer.render(0.5), kThing, kMaskMoving), 0) << name;
    EXPECT_GT(pixelsOf(renderer.render(2.5), kThing, kMaskMoving), 40) << name;
    const RenderedFrame late = renderer.render(9.5);
    EXPECT_EQ(pixelsOf(late, kThing, kMaskMoving), 0) << name;
    EXPECT_GT(pixelsOf(late, kThing, kMaskStanding), 40) << name;
    const Eigen::Vector3d way = built.scene.movers[kThing].poses(9.5)[0].translation() -
                                built.scene.movers[kThing].poses(0.0)[0].translation();
    EXPECT_GT(way.norm(), 1.0) << name;
  }
}

TEST(SceneCatalog, ThingsThatMoveByThemselvesHaveNoPersonAndMove) {
  for (const char* name : {"balloon", "opening_door", "robot_vacuum"}) {
    const BuiltScene built = grey(name);
    ASSERT_EQ(built.scene.movers.size(), 1U) << name;
    EXPECT_FALSE(built.scene.movers[0].is_person) << name;
    Renderer renderer(built.scene, thumbnail());
    EXPECT_GT(pixelsOf(renderer.render(2.0), 0, kMaskMoving), 20) << name;
  }
}

TEST(SceneCatalog, AnotherSeedIsAnotherSequence) {
  SceneOptions options = quick(1.0);
  options.paint = false;
  const BuiltScene one = buildScene("walking_static", options);
  options.seed = 2;
  const BuiltScene two = buildScene("walking_static", options);
  // Another hand holds the camera, and other people sit there.
  EXPECT_GT((one.scene.camera(0.5).translation() - two.scene.camera(0.5).translation()).norm(),
            1e-5);
  EXPECT_NE(one.scene.movers[0].parts[0].radius, two.scene.movers[0].parts[0].radius);
}

}  // namespace
}  // namespace hmcdyn::synthesize

// SPDX-License-Identifier: BSD-3-Clause
#include "slam/map/local_mapper.hpp"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <filesystem>
#include <iterator>
#include <random>
#include <set>
#include <string>
#include <thread>
#include <utility>

#include <gtest/gtest.h>

#include "slam/map/local_bundle.hpp"
#include "track/room.hpp"

namespace hmcdyn::slam {
namespace {

/// Six key frames that see one room; the poses of all but the first are a little wrong.
Map disturbedMap() {
  const Room room(21, 200);
  Map map(kCamera, {});
  std::mt19937 random(5);
  for (int k = 0; k < 6; ++k) {
    const Eigen::Isometry3d truth = movedBy(0.02 * k, 0.0);
    Frame frame = room.see(static_cast<std::size_t>(k), truth);
    frame.camera_from_world = truth;
    if (k > 0) {
      frame = tied(std::move(frame), map);
      frame.camera_from_world.translation().x() += 0.004 * (random() % 3 == 0 ? -1.0 : 1.0);
    }
    map.insertKeyFrame(frame);
  }
  for (std::size_t i = 0; i < map.points().size(); ++i) {
    map.count(static_cast<int>(i), true, {});
    map.count(static_cast<int>(i), true, {});  // trusted
  }
  return map;
}

double worstPose(const Map& map) {
  double worst = 0.0;
  for (int k = 0; k < static_cast<int>(map.keyFrames().size()); ++k) {
    worst = std::max(worst, distanceBetween(map.poseOf(k), movedBy(0.02 * k, 0.0)));
  }
  return worst;
}

TEST(LocalBundle, HoldsTheFirstKeyFrameAndTakesTrustedPointsOnly) {
  Map map = disturbedMap();
  for (int k = 0; k < 2; ++k) {
    map.count(0, true, {PointLabel::kDynamic, 0.0f, true});
  }
  const LocalBundle bundle = makeLocalBundle(map);
  ASSERT_EQ(bundle.key_frames.size(), 6U);
  for (std::size_t k = 0; k < bundle.key_frames.size(); ++k) {
    EXPECT_EQ(bundle.problem.poses[k].fixed, bundle.key_frames[k] == 0);
  }
  const auto seen_twice =
      std::count_if(map.points().begin() + 1, map.points().end(),
                    [](const MapPoint& point) { return point.observations.size() >= 2; });
  EXPECT_EQ(static_cast<std::ptrdiff_t>(bundle.points.size()), seen_twice);
  EXPECT_EQ(std::count(bundle.points.begin(), bundle.points.end(), 0), 0);
}

TEST(LocalBundle, FarKeyFramesAreFixed) {
  LocalBundleOptions options;
  options.free_key_frames = 2;
  options.fixed_key_frames = 3;
  const LocalBundle bundle = makeLocalBundle(disturbedMap(), options);
  ASSERT_EQ(bundle.key_frames.size(), 5U);
  EXPECT_EQ(bundle.key_frames.front(), 5) << "the latest is free";
  std::size_t fixed = 0;
  for (const BundlePose& pose : bundle.problem.poses) {
    fixed += pose.fixed ? 1 : 0;
  }
  EXPECT_GE(fixed, 3U);
}

TEST(LocalBundle, AFailedAdjustmentCallsNothingAnOutlier) {
  const LocalBundle bundle = makeLocalBundle(disturbedMap());
  BundleSolution failed;
  for (const BundlePose& pose : bundle.problem.poses) {
    failed.poses.push_back(pose.camera_from_world);
  }
  failed.points = bundle.problem.points;
  failed.depth_offsets.assign(failed.points.size(), 0.0);
  failed.inlier.assign(bundle.problem.observations.size(), 0);
  failed.rounds = 1;
  failed.termination = BundleTermination::kNumericalFailure;
  EXPECT_TRUE(toCorrection(bundle, failed).outliers.empty());
  failed.termination = BundleTermination::kConverged;
  EXPECT_EQ(toCorrection(bundle, failed).outliers.size(), failed.inlier.size());
}

TEST(LocalBundle, OneKeyFrameGivesNothingToDo) {
  Map map(kCamera, {});
  map.insertKeyFrame(Room(3).see(0, movedBy(0.0, 0.0)));
  EXPECT_TRUE(makeLocalBundle(map).points.empty());
}

TEST(LocalMapper, PutsADisturbedMapRight) {
  Map map = disturbedMap();
  const double before = worstPose(map);
  LocalMapper mapper({});
  mapper.adjust(map);
  EXPECT_TRUE(mapper.busy());
  EXPECT_FALSE(mapper.poll().has_value()) << "not before its time";
  const std::optional<MapCorrection> correction = mapper.poll();
  ASSERT_TRUE(correction.has_value());
  map.apply(*correction);
  EXPECT_GT(before, 0.003);
  EXPECT_LT(worstPose(map), 0.1 * before);
  EXPECT_EQ(mapper.adjustments(), 1U);
}

TEST(LocalMapper, GivesTheSameResultEveryTime) {
  Map one = disturbedMap();
  Map other = disturbedMap();
  for (Map* map : {&one, &other}) {
    LocalMapper mapper({});
    mapper.adjust(*map);
    map->apply(*mapper.finish());
  }
  for (int k = 0; k < 6; ++k) {
    EXPECT_EQ(one.poseOf(k).matrix(), other.poseOf(k).matrix());
  }
}

TEST(LocalMapper, SwitchedOffItDoesNothing) {
  LocalMapperOptions options;
  options.enabled = false;
  LocalMapper mapper(options);
  mapper.adjust(disturbedMap());
  EXPECT_FALSE(mapper.busy());
  EXPECT_FALSE(mapper.finish().has_value());
}

/// Their numbers, as the kernel gives them. One that was joined may be among them for some moments.
std::set<std::string> threadsOfThisProcess() {
  std::set<std::string> threads;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
    threads.insert(task.path().filename().string());
  }
  return threads;
}

std::set<std::string> startedSince(const std::set<std::string>& before) {
  const std::set<std::string> now = threadsOfThisProcess();
  std::set<std::string> started;
  std::set_difference(now.begin(), now.end(), before.begin(), before.end(),
                      std::inserter(started, started.end()));
  return started;
}

/// True as soon as no thread is left but those of `before`; one never joined stays.
bool allEndedSince(const std::set<std::string>& before) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point last = Clock::now() + std::chrono::seconds(20);
  while (!startedSince(before).empty()) {
    if (Clock::now() > last) {
      return false;
    }
    std::this_thread::yield();
  }
  return true;
}

TEST(LocalMapper, EndsWithWorkOutstanding) {
  if (!std::filesystem::exists("/proc/self/task")) {
    GTEST_SKIP() << "no /proc/self/task: the threads of a process cannot be told";
  }
  // A process' first thread may bring a second one along, the sanitizer's own, that stays.
  std::thread([] {}).join();
  const std::set<std::string> before = threadsOfThisProcess();
  {
    LocalMapper mapper({});
    mapper.adjust(disturbedMap());
    EXPECT_EQ(startedSince(before).size(), 1u);
  }
  EXPECT_TRUE(allEndedSince(before)) << "the destructor did not join the thread";
}

}  // namespace
}  // namespace hmcdyn::slam

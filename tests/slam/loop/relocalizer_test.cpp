// SPDX-License-Identifier: BSD-3-Clause
#include "slam/loop/relocalizer.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <map>
#include <string>
#include <utility>

#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "invalid_argument.hpp"
#include "loop/place_scene.hpp"
#include "loop/poster.hpp"

namespace hmcdyn::slam {
namespace {

using hmcdyn::test::invalidArgumentOf;
using namespace hmcdyn::slam::test;  // NOLINT(google-build-using-namespace): the scene's words

Landmarks filledRoom(std::uint32_t seed) {
  Random random(seed);
  return scattered(random, 900, {-3.0, -1.1, 1.8}, {3.0, 1.1, 3.5});
}

Eigen::Isometry3d at(double x) { return motionOf({0.0, 0.05 * x, 0.02}, {-x, 0.1, 0.0}); }

/// Key frames 100, 101, ... half a metre from each other, and the index over them.
struct KnownRoom {
  PlaceIndex index;
  std::map<std::size_t, LoopKeyFrame> key_frames;

  explicit KnownRoom(const Landmarks& landmarks, int n = 6, const SightNoise& noise = kUsualNoise) {
    for (int k = 0; k < n; ++k) {
      const std::size_t id = 100 + static_cast<std::size_t>(k);
      key_frames[id] =
          see(landmarks, id, at(-1.25 + 0.5 * k), static_cast<std::uint32_t>(k) + 5, noise);
      index.add(id, key_frames[id].descriptors);
    }
  }

  RelocalizationResult find(const LoopKeyFrame& frame,
                            const RelocalizerOptions& options = {}) const {
    return relocalize(frame, index, key_frames, kLens, options);
  }
};

/// A frame that knows nothing but what it sees.
LoopKeyFrame lostAt(const Landmarks& landmarks, const Eigen::Isometry3d& pose,
                    const SightNoise& noise = kUsualNoise) {
  LoopKeyFrame frame = see(landmarks, 0, pose, 77, noise);
  frame.camera_from_world = motionOf({1.0, 2.0, 3.0}, {50.0, 0.0, 0.0});  // not looked at
  frame.map_point.clear();
  return frame;
}

TEST(Relocalizer, FindsAFrameInAKnownRoom) {
  const Landmarks landmarks = filledRoom(1);
  const KnownRoom known(landmarks);
  for (const double x : {-1.1, 0.0, 0.4, 1.2}) {
    const Eigen::Isometry3d truth = motionOf({0.1, -0.2, 0.3}, {-x, 0.0, 0.2});
    const RelocalizationResult result = known.find(lostAt(landmarks, truth));
    ASSERT_TRUE(result.camera_from_world) << "at " << x;
    EXPECT_LT(metresBetween(*result.camera_from_world, truth), 0.01) << "at " << x;
    EXPECT_LT(radiansBetween(*result.camera_from_world, truth), 0.003) << "at " << x;
    EXPECT_EQ(result.method, RelocalizationMethod::kRigid);
    EXPECT_EQ(result.tried, 1U);  // the first gave enough
    EXPECT_EQ(result.matches.size(), result.most_inliers);
    EXPECT_GE(result.most_matches, result.most_inliers);
  }
}

TEST(Relocalizer, WithoutNoiseThePoseIsExact) {
  const Landmarks landmarks = filledRoom(2);
  const KnownRoom known(landmarks, 6, {});
  const RelocalizationResult result = known.find(lostAt(landmarks, at(0.1), {}));
  ASSERT_TRUE(result.camera_from_world);
  EXPECT_LT(metresBetween(*result.camera_from_world, at(0.1)), 1e-4);  // pixels are floats
}

TEST(Relocalizer, TriesOnUntilThereAreEnoughInliersAndTakesTheBest) {
  const Landmarks landmarks = filledRoom(15);
  const KnownRoom known(landmarks);
  const LoopKeyFrame frame = lostAt(landmarks, at(0.3));
  RelocalizerOptions options;
  options.enough_inliers = 100000;
  const RelocalizationResult best_of_all = known.find(frame, options);
  EXPECT_EQ(best_of_all.tried, 5U);
  EXPECT_GE(best_of_all.most_inliers, known.find(frame).most_inliers);
  EXPECT_EQ(best_of_all.matches.size(), best_of_all.most_inliers);
  options.enough_inliers = 0;
  EXPECT_EQ(known.find(frame, options).tried, 1U);
  // Enough is not before there is a pose.
  EXPECT_EQ(known.find(lostAt(filledRoom(16), at(0.0)), options).tried, 5U);
}

// Each match is one landmark, by its number in the key frame and what the frame sees of it.
TEST(Relocalizer, NamesTheMapPointsThatItSaw) {
  const Landmarks landmarks = filledRoom(3);
  const KnownRoom known(landmarks);
  const LoopKeyFrame truth = see(landmarks, 0, at(0.3), 77, kUsualNoise);
  const RelocalizationResult result = known.find(lostAt(landmarks, at(0.3)));
  ASSERT_TRUE(result.camera_from_world);
  ASSERT_GE(result.matches.size(), 100U);
  const LoopKeyFrame& key_frame = known.key_frames.at(result.key_frame);
  for (const RelocalizationMatch& match : result.matches) {
    EXPECT_EQ(match.map_point, truth.map_point[static_cast<std::size_t>(match.key_point)]);
    EXPECT_EQ(match.map_point,
              key_frame.map_point[static_cast<std::size_t>(match.key_frame_key_point)]);
  }
}

// The sensor gives no depth any more: pixels against the points of the key frame.
TEST(Relocalizer, FindsAFrameWithoutDepth) {
  const Landmarks landmarks = filledRoom(4);
  const KnownRoom known(landmarks);
  LoopKeyFrame frame = lostAt(landmarks, at(0.2));
  std::fill(frame.points.depth.begin(), frame.points.depth.end(), 0.0f);
  const RelocalizationResult result = known.find(frame);
  ASSERT_TRUE(result.camera_from_world);
  EXPECT_EQ(result.method, RelocalizationMethod::kPerspective);
  EXPECT_LT(metresBetween(*result.camera_from_world, at(0.2)), 0.02);
}

// A person covers two thirds of the view.
TEST(Relocalizer, FindsAFrameThatSeesLittle) {
  const Landmarks landmarks = filledRoom(5);
  const KnownRoom known(landmarks);
  const LoopKeyFrame all = lostAt(landmarks, at(0.2));
  LoopKeyFrame frame;
  for (std::size_t i = 0; i < all.points.size(); ++i) {
    if (all.points.u[i] < 213.0f) {
      frame.descriptors.push_back(all.descriptors.row(static_cast<int>(i)));
      frame.points.push_back(all.points.u[i], all.points.v[i], all.points.depth[i]);
      frame.sigma.push_back(1.0f);
    }
  }
  const RelocalizationResult result = known.find(frame);
  ASSERT_TRUE(result.camera_from_world);
  EXPECT_LT(metresBetween(*result.camera_from_world, at(0.2)), 0.03);
}

TEST(Relocalizer, AnUnknownRoomIsNotFound) {
  const KnownRoom known(filledRoom(6));
  const RelocalizationResult result = known.find(lostAt(filledRoom(7), at(0.0)));
  EXPECT_FALSE(result.camera_from_world);
  EXPECT_EQ(result.method, RelocalizationMethod::kNone);
  EXPECT_TRUE(result.matches.empty());
  EXPECT_LT(result.most_inliers, 20U);
}

// Looks the same, point by point, but the points are elsewhere.
TEST(Relocalizer, ARoomThatOnlyLooksAlikeIsNotFound) {
  const Landmarks landmarks = filledRoom(8);
  const KnownRoom known(landmarks);
  Landmarks other = filledRoom(9);
  for (std::size_t i = 0; i < other.size(); ++i) {
    other[i].descriptor = landmarks[i].descriptor;
  }
  const RelocalizationResult result = known.find(lostAt(other, at(0.0)));
  EXPECT_FALSE(result.camera_from_world);
  EXPECT_GT(result.most_matches, 100U);
}

// A lost camera sees the poster of a known room in another one.
TEST(Relocalizer, APosterThatHangsInTwoPlacesDoesNotFoolIt) {
  struct Places {
    Landmarks known;
    Landmarks other;
  };
  constexpr int kOnWall = 700;  // some 700 key points in the image, as ORB has them
  for (const int on_poster : {60, 120, 250, 500}) {
    for (const Places& places :
         {Places{withPoster(filledRoom(31), {-0.4, 0.2, 2.4}, on_poster),
                 withPoster(filledRoom(32), {0.3, -0.2, 2.2}, on_poster)},
          Places{withPoster(pictureWall(33, kOnWall), {-0.4, 0.2, 2.4}, on_poster),
                 withPoster(pictureWall(34, kOnWall), {0.2, 0.0, 2.4}, on_poster)}}) {
      const KnownRoom known(places.known);
      const RelocalizationResult deceived = known.find(lostAt(places.other, at(0.0)));
      EXPECT_FALSE(deceived.camera_from_world) << on_poster;
      EXPECT_GE(deceived.contradicted, 1U) << on_poster << ": the test does not tell";
      // Its own poster is as good as anything else.
      const RelocalizationResult found = known.find(lostAt(places.known, at(0.0)));
      ASSERT_TRUE(found.camera_from_world) << on_poster;
      EXPECT_LT(metresBetween(*found.camera_from_world, at(0.0)), 0.01) << on_poster;
      RelocalizerOptions trusting;
      trusting.min_coverage = 0.0;
      EXPECT_TRUE(known.find(lostAt(places.other, at(0.0)), trusting).camera_from_world);
    }
  }
}

// People cover two thirds of the image: what is behind them is not seen, and denies nothing.
TEST(Relocalizer, WhatIsHiddenIsNoContradiction) {
  const Landmarks landmarks = filledRoom(35);
  const KnownRoom known(landmarks);
  const LoopKeyFrame all = lostAt(landmarks, at(0.1));
  LoopKeyFrame some;
  some.camera_from_world = all.camera_from_world;
  for (std::size_t i = 0; i < all.points.size(); ++i) {
    if (all.points.u[i] < 213.0f) {
      some.descriptors.push_back(all.descriptors.row(static_cast<int>(i)));
      some.points.push_back(all.points.u[i], all.points.v[i], all.points.depth[i]);
      some.sigma.push_back(all.sigma[i]);
    }
  }
  // One of them has a few corners of his own, which the filter missed.
  Random random(36);
  for (int i = 0; i < 12; ++i) {
    some.descriptors.push_back(randomDescriptor(random));
    some.points.push_back(static_cast<float>(random.uniform(400.0, 470.0)),
                          static_cast<float>(random.uniform(200.0, 270.0)), 1.5f);
    some.sigma.push_back(1.0f);
  }
  const RelocalizationResult found = known.find(some);
  ASSERT_TRUE(found.camera_from_world);
  EXPECT_LT(metresBetween(*found.camera_from_world, at(0.1)), 0.01);
  EXPECT_EQ(found.contradicted, 0U);
}

TEST(Relocalizer, NothingIsFoundInAnEmptyMapOrByAnEmptyFrame) {
  const Landmarks landmarks = filledRoom(10);
  const KnownRoom nothing(landmarks, 0);
  EXPECT_FALSE(nothing.find(lostAt(landmarks, at(0.0))).camera_from_world);
  EXPECT_EQ(nothing.find(lostAt(landmarks, at(0.0))).tried, 0U);
  const KnownRoom known(landmarks);
  EXPECT_FALSE(known.find(LoopKeyFrame{}).camera_from_world);
  EXPECT_FALSE(nothing.find(LoopKeyFrame{}).camera_from_world);
}

// The map may have culled key frames of which the index still knows.
TEST(Relocalizer, KeyFramesThatAreGoneArePassedOver) {
  const Landmarks landmarks = filledRoom(11);
  KnownRoom known(landmarks);
  const LoopKeyFrame frame = lostAt(landmarks, at(0.25));
  const std::size_t best = known.find(frame).key_frame;
  known.key_frames.erase(best);
  const RelocalizationResult result = known.find(frame);
  ASSERT_TRUE(result.camera_from_world);
  EXPECT_NE(result.key_frame, best);
  known.key_frames.clear();
  EXPECT_FALSE(known.find(frame).camera_from_world);
}

TEST(Relocalizer, DegeneratePointsFindNothing) {
  const Landmarks landmarks = filledRoom(12);
  const KnownRoom known(landmarks);
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  LoopKeyFrame nowhere = lostAt(landmarks, at(0.0));
  std::fill(nowhere.points.u.begin(), nowhere.points.u.end(), kNan);
  EXPECT_FALSE(known.find(nowhere).camera_from_world);
  LoopKeyFrame one_place = lostAt(landmarks, at(0.0));
  std::fill(one_place.points.u.begin(), one_place.points.u.end(), 320.0f);
  std::fill(one_place.points.v.begin(), one_place.points.v.end(), 240.0f);
  for (const float depth : {2.0f, 0.0f, kNan}) {
    std::fill(one_place.points.depth.begin(), one_place.points.depth.end(), depth);
    EXPECT_FALSE(known.find(one_place).camera_from_world) << depth;
  }
  KnownRoom blind(landmarks);
  for (auto& [id, key_frame] : blind.key_frames) {
    std::fill(key_frame.points.depth.begin(), key_frame.points.depth.end(), 0.0f);
  }
  EXPECT_FALSE(blind.find(lostAt(landmarks, at(0.0))).camera_from_world);
}

TEST(Relocalizer, TheSameFrameGivesTheSamePoseBitForBit) {
  const Landmarks landmarks = filledRoom(13);
  const KnownRoom known(landmarks);
  LoopKeyFrame frame = lostAt(landmarks, at(0.2));
  EXPECT_EQ(known.find(frame).camera_from_world->matrix(),
            known.find(frame).camera_from_world->matrix());
  std::fill(frame.points.depth.begin(), frame.points.depth.end(), 0.0f);  // OpenCV's draws, too
  EXPECT_EQ(known.find(frame).camera_from_world->matrix(),
            known.find(frame).camera_from_world->matrix());
}

TEST(Relocalizer, MistakesAreNamed) {
  const Landmarks landmarks = filledRoom(14);
  KnownRoom known(landmarks);
  const LoopKeyFrame frame = lostAt(landmarks, at(0.0));
  RelocalizerOptions options;
  options.pnp_iterations = 0;
  EXPECT_EQ(invalidArgumentOf([&] { known.find(frame, options); }),
            "options.pnp_iterations is 0, expected at least 1");
  options = {};
  options.pnp_reprojection = 0.0f;
  EXPECT_EQ(invalidArgumentOf([&] { known.find(frame, options); }),
            "options.pnp_reprojection is 0.000000, expected finite and > 0");
  LoopKeyFrame bad = frame;
  bad.sigma.pop_back();
  EXPECT_NE(invalidArgumentOf([&] { known.find(bad); }).find("size of frame.sigma is"),
            std::string::npos);
  for (auto& [id, key_frame] : known.key_frames) {
    key_frame.camera_from_world.linear() *= 2.0;
  }
  EXPECT_EQ(
      invalidArgumentOf([&] { known.find(frame); }),
      "key_frames.camera_from_world is not a rigid motion, expected a rotation and a translation");
}

}  // namespace
}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#include <cstdint>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include <hmcdyn/votes/motion_belief.hpp>

#include "belief_frame.hpp"
#include "invalid_argument.hpp"

namespace hmcdyn {
namespace {

struct Remembered {
  float u, v, depth, belief, weight;
};

MotionBelief memoryOf(const std::vector<Remembered>& points) {
  MotionBelief memory;
  for (const Remembered& point : points) {
    memory.u.push_back(point.u);
    memory.v.push_back(point.v);
    memory.depth.push_back(point.depth);
    memory.belief.push_back(point.belief);
    memory.weight.push_back(point.weight);
  }
  return memory;
}

/// What is known of a point that was at (u, v), at that depth.
KnownMotion known(const MotionBelief& memory, float u, float v, float depth) {
  MotionBeliefWorkspace workspace;
  const std::vector<float> at_depth{depth};
  const std::vector<float> at_u{u};
  const std::vector<float> at_v{v};
  return knownMotion(at_depth, at_u, at_v, memory, test::fixedBeliefOptions(), workspace).at(0);
}

bool moved(const MotionBelief& memory, float u, float v, float depth) {
  return known(memory, u, v, depth) == KnownMotion::kMoving;
}

TEST(KnownMotionOf, WhatWasBelievedThereAndAtThatDepth) {
  // Given one point that moved: its memory reaches sqrt(8) * 24 = 67.9 px, sqrt(8) * 0.11 = 0.31 m
  const MotionBelief memory = memoryOf({{100, 50, 2.0f, 1.0f, 0.5f}});
  EXPECT_TRUE(moved(memory, 100, 50, 2.0f));
  EXPECT_TRUE(moved(memory, 140, 50, 2.1f));
  EXPECT_FALSE(moved(memory, 169, 50, 2.0f));
  EXPECT_FALSE(moved(memory, 100, 50, 3.0f)) << "the wall behind";
}

TEST(KnownMotionOf, NeighboursAreAveragedByTheirNearness) {
  // Given one that moved and one at rest, 24 px apart: beside the first (1 : 0.586182) the mean is
  // 0.630, halfway 0.5, and a belief above 0.6 counts
  const MotionBelief memory = memoryOf({{100, 50, 2.0f, 1.0f, 0.9f}, {124, 50, 2.0f, 0.0f, 0.9f}});
  EXPECT_TRUE(moved(memory, 100, 50, 2.0f));
  EXPECT_FALSE(moved(memory, 112, 50, 2.0f));
  EXPECT_FALSE(moved(memory, 124, 50, 2.0f));
}

TEST(KnownMotionOf, NothingIsKnownWithoutAMatchADepthOrAMemory) {
  const MotionBelief memory = memoryOf(
      {{100, 50, 2.0f, 1.0f, 0.5f}, {kNaN, 50, 2.0f, 1.0f, 0.5f}, {100, 50, 2.0f, kNaN, 0.0f}});
  EXPECT_TRUE(moved(memory, 100, 50, 2.0f)) << "what is not placed says nothing";
  EXPECT_FALSE(moved(memory, kNaN, 50, 2.0f));
  EXPECT_FALSE(moved(memory, 100, kNaN, 2.0f));
  EXPECT_FALSE(moved(memory, 100, 50, 0.0f));
  EXPECT_FALSE(moved(memory, 100, 50, kNaN));
  EXPECT_EQ(known({}, 100, 50, 2.0f), KnownMotion::kUnknown);
  EXPECT_EQ(known(memory, kNaN, 50, 2.0f), KnownMotion::kUnknown);
  EXPECT_FALSE(moved(memoryOf({{100, 50, 2.0f, 1.0f, 0.0f}}), 100, 50, 2.0f)) << "a guess";
}

TEST(KnownMotionOf, AtRestIsOnlyWhatACertainNeighbourSays) {
  // Given a belief "at rest" just below, and just at, half of a full weight
  EXPECT_EQ(known(memoryOf({{100, 50, 2.0f, 0.0f, 0.49f}}), 100, 50, 2.0f), KnownMotion::kUnknown);
  const MotionBelief certain = memoryOf({{100, 50, 2.0f, 0.0f, 0.5f}});
  EXPECT_EQ(known(certain, 100, 50, 2.0f), KnownMotion::kAtRest);
  // Its reach is that of every memory: 67.9 px, and 0.44 m at a depth of 2.5 m.
  EXPECT_EQ(known(certain, 160, 50, 2.0f), KnownMotion::kAtRest);
  EXPECT_EQ(known(certain, 169, 50, 2.0f), KnownMotion::kUnknown);
  EXPECT_EQ(known(certain, 100, 50, 2.5f), KnownMotion::kUnknown);
}

TEST(KnownMotionOf, ManyGuessesDoNotMakeACertainty) {
  // Given a thing that has just appeared: ten neighbours that are believed to be at rest, a little
  std::vector<Remembered> guesses(10, {100, 50, 2.0f, 0.0f, 0.3f});
  EXPECT_EQ(known(memoryOf(guesses), 100, 50, 2.0f), KnownMotion::kUnknown);
  // But a guess that it moves is enough to keep it from speaking for the camera.
  for (Remembered& guess : guesses) {
    guess.belief = 1.0f;
  }
  EXPECT_EQ(known(memoryOf(guesses), 100, 50, 2.0f), KnownMotion::kMoving);
}

TEST(KnownMotionOf, UnequalArraysAreNamed) {
  MotionBeliefWorkspace workspace;
  const std::vector<float> two(2, 1.0f);
  const std::vector<float> one(1, 1.0f);
  EXPECT_EQ(test::invalidArgumentOf(
                [&] { knownMotion(two, one, two, {}, test::fixedBeliefOptions(), workspace); }),
            "knownMotion: 2 depths, but 1 columns and 2 rows; expected equal sizes");
  MotionBelief unequal = memoryOf({{100, 50, 2.0f, 1.0f, 0.5f}});
  unequal.v.clear();
  EXPECT_THROW(knownMotion(one, one, one, unequal, test::fixedBeliefOptions(), workspace),
               std::invalid_argument);
}

}  // namespace
}  // namespace hmcdyn

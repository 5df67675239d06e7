// SPDX-License-Identifier: BSD-3-Clause
#include <cstdint>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include <hmcdyn/motion_belief.hpp>

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

/// Whether a point that was at (u, v), at that depth, is remembered to move.
bool moved(const MotionBelief& memory, float u, float v, float depth) {
  MotionBeliefWorkspace workspace;
  const std::vector<float> at_depth{depth};
  const std::vector<float> at_u{u};
  const std::vector<float> at_v{v};
  return rememberedToMove(at_depth, at_u, at_v, memory, test::fixedBeliefOptions(), workspace)
             .at(0) != 0;
}

TEST(RememberedToMove, WhatWasBelievedThereAndAtThatDepth) {
  // Given one point that moved: its memory reaches sqrt(8) * 24 = 67.9 px, sqrt(8) * 0.11 = 0.31 m
  const MotionBelief memory = memoryOf({{100, 50, 2.0f, 1.0f, 0.5f}});
  EXPECT_TRUE(moved(memory, 100, 50, 2.0f));
  EXPECT_TRUE(moved(memory, 140, 50, 2.1f));
  EXPECT_FALSE(moved(memory, 169, 50, 2.0f));
  EXPECT_FALSE(moved(memory, 100, 50, 3.0f)) << "the wall behind";
}

TEST(RememberedToMove, NeighboursAreAveragedByTheirNearness) {
  // Given one that moved and one at rest, 24 px apart: beside the first (1 : 0.586182) the mean is
  // 0.630, halfway 0.5, and a belief above 0.6 counts
  const MotionBelief memory = memoryOf({{100, 50, 2.0f, 1.0f, 0.9f}, {124, 50, 2.0f, 0.0f, 0.9f}});
  EXPECT_TRUE(moved(memory, 100, 50, 2.0f));
  EXPECT_FALSE(moved(memory, 112, 50, 2.0f));
  EXPECT_FALSE(moved(memory, 124, 50, 2.0f));
}

TEST(RememberedToMove, NothingIsKnownWithoutAMatchADepthOrAMemory) {
  const MotionBelief memory = memoryOf(
      {{100, 50, 2.0f, 1.0f, 0.5f}, {kNaN, 50, 2.0f, 1.0f, 0.5f}, {100, 50, 2.0f, kNaN, 0.0f}});
  EXPECT_TRUE(moved(memory, 100, 50, 2.0f)) << "what is not placed says nothing";
  EXPECT_FALSE(moved(memory, kNaN, 50, 2.0f));
  EXPECT_FALSE(moved(memory, 100, kNaN, 2.0f));
  EXPECT_FALSE(moved(memory, 100, 50, 0.0f));
  EXPECT_FALSE(moved(memory, 100, 50, kNaN));
  EXPECT_FALSE(moved({}, 100, 50, 2.0f));
  EXPECT_FALSE(moved(memoryOf({{100, 50, 2.0f, 1.0f, 0.0f}}), 100, 50, 2.0f)) << "a guess";
}

TEST(RememberedToMove, UnequalArraysAreNamed) {
  MotionBeliefWorkspace workspace;
  const std::vector<float> two(2, 1.0f);
  const std::vector<float> one(1, 1.0f);
  EXPECT_EQ(test::invalidArgumentOf([&] {
              rememberedToMove(two, one, two, {}, test::fixedBeliefOptions(), workspace);
            }),
            "rememberedToMove: 2 depths, but 1 columns and 2 rows; expected equal sizes");
  MotionBelief unequal = memoryOf({{100, 50, 2.0f, 1.0f, 0.5f}});
  unequal.v.clear();
  EXPECT_THROW(rememberedToMove(one, one, one, unequal, test::fixedBeliefOptions(), workspace),
               std::invalid_argument);
}

}  // namespace
}  // namespace hmcdyn

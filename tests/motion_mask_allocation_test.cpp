// SPDX-License-Identifier: BSD-3-Clause
// The motion mask allocates nothing once it has seen frames of the kind. This executable replaces
// the global operator new, so that every allocation counts.
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include <hmcdyn/motion_mask.hpp>

#include "counting_allocator.hpp"
#include "sliding_thing.hpp"

namespace hmcdyn {
namespace {

TEST(MotionMaskAllocations, NoneInTheSteadyState) {
  // Given a board that goes to and fro every two seconds, drawn before anything is counted
  std::vector<test::SlidingThing> scenes;
  for (int k = 0; k < 360; ++k) {
    const double t = k / 30.0;
    scenes.emplace_back(t, 0.0, 0.4 * std::sin(3.14159265358979 * t));
  }
  MotionMaskEstimator estimator(test::SlidingThing::kCamera);
  std::vector<std::size_t> after;
  after.reserve(scenes.size() + 1);
  for (const test::SlidingThing& scene : scenes) {
    after.push_back(test::allocations());
    estimator.update(scene.frame());
  }
  after.push_back(test::allocations());
  // Then the first seconds allocate (so the count works), the last four do not
  EXPECT_GT(after[30] - after[0], 0U);
  EXPECT_EQ(after[360] - after[240], 0U);
}

}  // namespace
}  // namespace hmcdyn

// SPDX-License-Identifier: BSD-3-Clause
#include "regions/frame_regions.hpp"

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "counting_allocator.hpp"
#include "random.hpp"

namespace hmcdyn {
namespace {

/// 500 points of an image of 640 x 480 px.
KeyPoints scatteredPoints() {
  test::Random random(71);
  KeyPoints points;
  for (int i = 0; i < 500; ++i) {
    points.push_back(random.uniformFloat(0.0, 639.0), random.uniformFloat(0.0, 479.0), 2.0f);
  }
  return points;
}

TEST(FrameRegions, TheMembershipOfBoxesTakesItsMemoryOver) {
  const KeyPoints points = scatteredPoints();
  std::vector<std::size_t> source(points.size());
  std::iota(source.begin(), source.end(), 0U);
  internal::FrameRegions regions;
  regions.boxes = {{100, 100, 300, 400, 0, 1.0f}, {200, 50, 600, 300, 0, 1.0f}};
  const BoxMembership expected = internal::membershipOf(regions, source, points.view());
  ASSERT_EQ(expected.offsets.size(), 3U);
  ASSERT_GT(expected.indices.size(), 50U);
  BoxMembership reused = internal::membershipOf(regions, source, points.view());
  const std::size_t before = test::allocations();
  reused = internal::membershipOf(regions, source, points.view(), std::move(reused));
  EXPECT_EQ(test::allocations(), before);
  EXPECT_EQ(reused.offsets, expected.offsets);
  EXPECT_EQ(reused.indices, expected.indices);
}

TEST(FrameRegions, TheMembershipOfAMaskIsThatOfTheChosenPoints) {
  internal::FrameRegions regions;
  regions.by_mask = true;
  regions.boxes.resize(2);
  regions.region = {0, kNoRegion, 1, 1, 0};  // of all five points
  const std::vector<std::size_t> source{4, 1, 2};
  KeyPoints chosen;
  for (std::size_t k = 0; k < source.size(); ++k) {
    chosen.push_back(1.0f, 1.0f, 1.0f);
  }
  BoxMembership old;
  old.indices.assign(100, 7);
  const BoxMembership found =
      internal::membershipOf(regions, source, chosen.view(), std::move(old));
  EXPECT_EQ(found.offsets, (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_EQ(found.indices, (std::vector<std::uint32_t>{0, 2}));
}

}  // namespace
}  // namespace hmcdyn

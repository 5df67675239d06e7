// SPDX-License-Identifier: BSD-3-Clause
#include "mask/coupling.hpp"

#include <cmath>
#include <cstddef>

#include <gtest/gtest.h>

namespace hmcdyn::internal {
namespace {

constexpr int kWidth = 40;
constexpr int kHeight = 30;

/// A frame whose depth at each column is that of a function.
template <class DepthAt>
SmallFrame frameOf(DepthAt depth_at) {
  SmallFrame frame;
  frame.width = kWidth;
  frame.height = kHeight;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      frame.depth.push_back(depth_at(x, y));
    }
  }
  return frame;
}

float leftOf(const Couplings& couplings, int x) {
  return couplings.left[std::size_t{kHeight / 2} * kWidth + static_cast<std::size_t>(x)];
}
float aboveOf(const Couplings& couplings, int y) {
  return couplings.above[static_cast<std::size_t>(y) * kWidth + std::size_t{kWidth / 2}];
}

/// Of neighbours on one surface: Gastal and Oliveira 2011, equation 21.
float whole() { return std::exp(-std::sqrt(2.0f) / SegmentModel{}.reach); }

TEST(Coupling, PlaneIsOneSurface) {
  // 1 / depth is linear along a plane's image
  const SmallFrame floor = frameOf([](int x, int y) {
    return 1.0f / (0.5f + 0.0008f * static_cast<float>(x) + 0.0015f * static_cast<float>(y));
  });
  const Couplings couplings = coupleNeighbours(floor, {}, true, {});
  for (int x = 1; x < kWidth; ++x) {
    EXPECT_NEAR(leftOf(couplings, x), whole(), 0.005f) << x;
  }
  for (int y = 1; y < kHeight; ++y) {
    EXPECT_NEAR(aboveOf(couplings, y), whole(), 0.005f) << y;
  }
}

TEST(Coupling, ConcaveCreaseParts) {
  // Two planes that meet at column 20 and come towards the camera by 12 mm a pixel: the chord of
  // six pixels is 36 mm nearer than the crease; 15 + 1.5 sqrt(1.5) 6.7 = 27 mm part.
  const auto valley = [](int x, int) {
    return 2.0f - 0.012f * std::abs(static_cast<float>(x) - 20.0f);
  };
  const Couplings couplings = coupleNeighbours(frameOf(valley), {}, true, {});
  EXPECT_LT(leftOf(couplings, 20), 0.25f * whole());
  EXPECT_LT(leftOf(couplings, 21), 0.25f * whole());
  EXPECT_NEAR(leftOf(couplings, 10), whole(), 0.03f);
  EXPECT_NEAR(leftOf(couplings, 30), whole(), 0.03f);
  const Couplings at_edges_alone = coupleNeighbours(frameOf(valley), {}, false, {});
  EXPECT_NEAR(leftOf(at_edges_alone, 20), whole(), 0.03f);
}

TEST(Coupling, ConcaveCreasePartsRowsAsWell) {
  const SmallFrame thing_on_floor =
      frameOf([](int, int y) { return y < 15 ? 2.0f : 2.0f - 0.03f * static_cast<float>(y - 15); });
  const Couplings couplings = coupleNeighbours(thing_on_floor, {}, true, {});
  EXPECT_LT(aboveOf(couplings, 15), 0.5f);
  EXPECT_NEAR(aboveOf(couplings, 8), whole(), 0.03f);
}

TEST(Coupling, ConvexEdgeHoldsTogether) {
  const SmallFrame edge_of_box =
      frameOf([](int x, int) { return 2.0f + 0.012f * std::abs(static_cast<float>(x) - 20.0f); });
  const Couplings couplings = coupleNeighbours(edge_of_box, {}, true, {});
  for (int x = 5; x < 35; ++x) {
    EXPECT_NEAR(leftOf(couplings, x), whole(), 0.03f) << x;
  }
}

TEST(Coupling, DepthEdgePartsAndIsNoCrease) {
  const SmallFrame step = frameOf([](int x, int) { return x < 20 ? 1.0f : 2.0f; });
  const Couplings couplings = coupleNeighbours(step, {}, true, {});
  EXPECT_LT(leftOf(couplings, 20), 0.001f);
  EXPECT_NEAR(leftOf(couplings, 19), whole(), 1e-4f);  // the chord would span the edge
  EXPECT_NEAR(leftOf(couplings, 22), whole(), 1e-4f);
}

TEST(Coupling, HolesAreNoCreases) {
  const SmallFrame hole = frameOf([](int x, int) { return x >= 18 && x < 22 ? 0.0f : 2.0f; });
  const Couplings couplings = coupleNeighbours(hole, {}, true, {});
  EXPECT_NEAR(leftOf(couplings, 17), whole(), 1e-4f);
  EXPECT_GT(leftOf(couplings, 18), 0.0f);
  EXPECT_LT(leftOf(couplings, 18), whole());
}

}  // namespace
}  // namespace hmcdyn::internal

// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <hmcdyn/votes/surface_depth.hpp>

#include "constants.hpp"
#include "invalid_argument.hpp"

namespace hmcdyn {
namespace {

using test::kInfinity;

constexpr int kSide = 41;     // of the drawn images (px)
constexpr float kAt = 20.0f;  // their middle

/// Every option set: 3 x 3 own pixels, 7 x 7 of the wide window.
SurfaceDepthOptions fixedOptions() {
  SurfaceDepthOptions options;
  options.own_radius = 1;
  options.own_share = 0.4f;
  options.wide_radius = 6;
  options.enclosed_share = 0.5f;
  options.behind_share = 0.1f;
  options.flow_radius = 4;
  options.gap_floor = 0.1f;
  options.gap_quadratic = 0.03f;
  return options;
}

struct Drawing {
  using Draw = std::function<float(int, int)>;

  Drawing(int columns, int rows, const Draw& depth_at) : width(columns), height(rows) {
    for (int r = 0; r < rows; ++r) {
      for (int c = 0; c < columns; ++c) {
        pixels.push_back(depth_at(c, r));
      }
    }
  }
  explicit Drawing(const Draw& depth_at) : Drawing(kSide, kSide, depth_at) {}

  DepthImageView view() const {
    return {pixels.data(), width, height, static_cast<std::size_t>(width)};
  }

  int width;
  int height;
  std::vector<float> pixels;
};

struct Answer {
  float depth;
  SurfaceSupport support;
  bool is_dragged;
};

Answer ask(const Drawing& drawing, float u, float v,
           const SurfaceDepthOptions& options = fixedOptions()) {
  const SurfaceDepths depths =
      surfaceDepths(drawing.view(), Span<const float>(&u, 1), Span<const float>(&v, 1), options);
  return {depths.depth.at(0), depths.support.at(0), depths.is_dragged.at(0) != 0};
}

Answer askMiddle(const Drawing& drawing, const SurfaceDepthOptions& options = fixedOptions()) {
  return ask(drawing, kAt, kAt, options);
}

/// A near surface up to column 16, its shadow up to column 22, and a wall.
Drawing edge(float near, float shadow, float wall) {
  return Drawing([=](int c, int) { return c <= 16 ? near : c <= 22 ? shadow : wall; });
}

TEST(SurfaceDepth, APointsOwnDepthIsTheMedianOfItsWindow) {
  // Given seven depths of nine: 1.9 2.0 2.1 [2.2] 2.3 2.4 2.9
  const std::vector<float> window{2.9f, 2.0f, 0.0f, 2.2f, kNaN, 2.1f, 2.4f, 1.9f, 2.3f};
  const Drawing drawing(3, 3,
                        [&](int c, int r) { return window[static_cast<std::size_t>(3 * r + c)]; });
  const Answer answer = ask(drawing, 1.2f, 0.8f);
  EXPECT_EQ(answer.support, SurfaceSupport::kMeasured);
  EXPECT_EQ(answer.depth, 2.2f);
}

TEST(SurfaceDepth, OfAnEvenNumberTheFartherMiddleOneCounts) {
  // Given 2.0 2.1 [2.2] 2.3
  const std::vector<float> window{2.3f, 0.0f, 2.0f, 0.0f, 0.0f, 0.0f, 2.2f, 0.0f, 2.1f};
  const Drawing drawing(3, 3,
                        [&](int c, int r) { return window[static_cast<std::size_t>(3 * r + c)]; });
  EXPECT_EQ(ask(drawing, 1.0f, 1.0f).depth, 2.2f);
}

TEST(SurfaceDepth, AWindowWithTooFewDepthsMeasuresNothing) {
  // Given 4 of 9 pixels (0.44), and 3 (0.33), where 0.4 is asked for
  const auto support_of = [](int pixels) {
    const Drawing drawing(3, 3, [&](int c, int r) { return 3 * r + c < pixels ? 2.0f : 0.0f; });
    return ask(drawing, 1.0f, 1.0f).support;
  };
  EXPECT_EQ(support_of(4), SurfaceSupport::kMeasured);
  EXPECT_EQ(support_of(3), SurfaceSupport::kNone);
}

TEST(SurfaceDepth, AHoleInANearSurfaceLiesOnIt) {
  // Given a hole of 5 x 5 pixels: 40 of the 49 of the wide window have the surface's depth.
  const Drawing drawing(
      [](int c, int r) { return std::abs(c - 20) <= 2 && std::abs(r - 20) <= 2 ? 0.0f : 2.0f; });
  const Answer answer = askMiddle(drawing);
  EXPECT_EQ(answer.support, SurfaceSupport::kEnclosed);
  EXPECT_EQ(answer.depth, 2.0f);
  EXPECT_FALSE(answer.is_dragged);

  SurfaceDepthOptions strict = fixedOptions();
  strict.enclosed_share = 0.82f;  // of 49 pixels, 40 are 0.816
  EXPECT_EQ(askMiddle(drawing, strict).support, SurfaceSupport::kBeside);
}

TEST(SurfaceDepth, OneBadPixelDecidesNothing) {
  // Given the same hole, and one pixel at 0.3 m in the wide window
  const Drawing drawing([](int c, int r) {
    const bool hole = std::abs(c - 20) <= 2 && std::abs(r - 20) <= 2;
    return hole ? 0.0f : c == 14 && r == 14 ? 0.3f : 2.0f;
  });
  EXPECT_EQ(askMiddle(drawing).support, SurfaceSupport::kEnclosed);
  EXPECT_EQ(askMiddle(drawing).depth, 2.0f);
}

TEST(SurfaceDepth, AShadowLiesOnTheFartherSurface) {
  // Given 14 pixels of 49 on either side of the shadow
  const Answer answer = askMiddle(edge(2.0f, 0.0f, 4.0f));
  EXPECT_EQ(answer.support, SurfaceSupport::kBehind);
  EXPECT_EQ(answer.depth, 4.0f);

  SurfaceDepthOptions strict = fixedOptions();
  strict.behind_share = 0.29f;  // 14 of 49 are 0.286
  EXPECT_EQ(askMiddle(edge(2.0f, 0.0f, 4.0f), strict).support, SurfaceSupport::kBeside);
}

TEST(SurfaceDepth, BesideANearSurfaceWithNothingBehindItIsDoubtful) {
  const Answer answer = askMiddle(edge(2.0f, 0.0f, 0.0f));
  EXPECT_EQ(answer.support, SurfaceSupport::kBeside);
  EXPECT_EQ(answer.depth, 0.0f);
  EXPECT_TRUE(answer.is_dragged);
}

TEST(SurfaceDepth, OutOfRangeThereIsNone) {
  const Answer answer = askMiddle(Drawing([](int, int) { return 0.0f; }));
  EXPECT_EQ(answer.support, SurfaceSupport::kNone);
  EXPECT_EQ(answer.depth, 0.0f);
  EXPECT_FALSE(answer.is_dragged);
}

TEST(SurfaceDepth, FourPixelsAreHardlyADepth) {
  // Given single depths where the wide window looks, in its upper row
  const auto support_of = [](int pixels) {
    return askMiddle(Drawing([&](int c, int r) {
             return r == 14 && c >= 14 && c < 14 + 2 * pixels && c % 2 == 0 ? 2.0f : 0.0f;
           }))
        .support;
  };
  EXPECT_EQ(support_of(4), SurfaceSupport::kNone);
  EXPECT_EQ(support_of(5), SurfaceSupport::kBeside);
}

TEST(SurfaceDepth, WhatCountsAsTwoSurfacesGrowsWithDepth) {
  // Given a gap of 0.1 + 0.03 * 9 = 0.37 m at 3 m
  const Answer one = askMiddle(edge(3.0f, 0.0f, 3.36f));
  EXPECT_EQ(one.support, SurfaceSupport::kEnclosed);
  EXPECT_EQ(one.depth, 3.36f);  // the farther middle one of 14 and 14
  const Answer two = askMiddle(edge(3.0f, 0.0f, 3.38f));
  EXPECT_EQ(two.support, SurfaceSupport::kBehind);
  EXPECT_EQ(two.depth, 3.38f);
}

TEST(SurfaceDepth, WhatIsNoDepthCountsAsNone) {
  for (const float none : {0.0f, -1.0f, kNaN, kInfinity, -kInfinity}) {
    EXPECT_EQ(askMiddle(edge(2.0f, none, 4.0f)).support, SurfaceSupport::kBehind) << none;
    EXPECT_EQ(askMiddle(edge(2.0f, none, none)).support, SurfaceSupport::kBeside) << none;
    EXPECT_EQ(askMiddle(edge(none, none, none)).support, SurfaceSupport::kNone) << none;
    EXPECT_FALSE(askMiddle(edge(none, 4.0f, 4.0f)).is_dragged) << none;
  }
}

TEST(SurfaceDepth, ANearerSurfaceWithinTheFlowWindowDrags) {
  // Given a wall of 4 m from column 17 on; at 4 m the gap is 0.1 + 0.03 * 16 = 0.58 m.
  SurfaceDepthOptions options = fixedOptions();
  EXPECT_TRUE(askMiddle(edge(2.0f, 4.0f, 4.0f), options).is_dragged);
  EXPECT_TRUE(askMiddle(edge(3.41f, 4.0f, 4.0f), options).is_dragged);
  EXPECT_FALSE(askMiddle(edge(3.43f, 4.0f, 4.0f), options).is_dragged);  // one surface
  EXPECT_FALSE(askMiddle(edge(6.0f, 4.0f, 4.0f), options).is_dragged);   // a farther one
  options.flow_radius = 3;                                               // reaches column 17
  EXPECT_FALSE(askMiddle(edge(2.0f, 4.0f, 4.0f), options).is_dragged);
}

TEST(SurfaceDepth, AShadowIsDraggedByWhatCastsIt) {
  SurfaceDepthOptions options = fixedOptions();
  EXPECT_TRUE(askMiddle(edge(2.0f, 0.0f, 4.0f), options).is_dragged);
  options.flow_radius = 3;
  EXPECT_FALSE(askMiddle(edge(2.0f, 0.0f, 4.0f), options).is_dragged);
}

TEST(SurfaceDepth, AtTheBorderThePixelsThatThereAreCount) {
  // Given a corner whose own window has 2 x 2 pixels, of which one, and two, have a depth
  const auto support_of = [](int pixels) {
    return ask(Drawing([&](int c, int r) { return r == 0 && c < pixels ? 2.0f : 0.0f; }), 0.0f,
               0.0f)
        .support;
  };
  EXPECT_EQ(support_of(1), SurfaceSupport::kNone);
  EXPECT_EQ(support_of(2), SurfaceSupport::kMeasured);
  // ... and a near surface beside the last column, which its flow window still reaches.
  const Drawing right([](int c, int) { return c <= 36 ? 2.0f : 4.0f; });
  EXPECT_TRUE(ask(right, 40.0f, 40.0f).is_dragged);
  EXPECT_EQ(ask(right, 40.0f, 40.0f).depth, 4.0f);
}

TEST(SurfaceDepth, PixelsOutsideTheImageHaveNone) {
  const Drawing wall([](int, int) { return 2.0f; });
  for (const float outside : {kNaN, kInfinity, -kInfinity, -0.5f, -7.0f, 40.5f, 1e9f}) {
    for (const bool is_column : {true, false}) {
      const Answer answer = is_column ? ask(wall, outside, kAt) : ask(wall, kAt, outside);
      EXPECT_EQ(answer.support, SurfaceSupport::kNone) << outside;
      EXPECT_EQ(answer.depth, 0.0f) << outside;
      EXPECT_FALSE(answer.is_dragged) << outside;
    }
  }
  for (const float inside : {-0.49f, 40.49f}) {
    EXPECT_EQ(ask(wall, inside, inside).support, SurfaceSupport::kMeasured) << inside;
  }
}

TEST(SurfaceDepth, ImagesSmallerThanTheWindowsAreFine) {
  const Drawing pixel(1, 1, [](int, int) { return 3.0f; });
  EXPECT_EQ(ask(pixel, 0.0f, 0.0f).depth, 3.0f);
  EXPECT_EQ(ask(Drawing(1, 1, [](int, int) { return 0.0f; }), 0.0f, 0.0f).support,
            SurfaceSupport::kNone);
  const Drawing strip(41, 2, [](int c, int) { return c <= 16 ? 2.0f : c <= 22 ? 0.0f : 4.0f; });
  EXPECT_EQ(ask(strip, kAt, 1.0f).support, SurfaceSupport::kNone);  // 2 of 4 and 2 of 7 pixels
}

TEST(SurfaceDepth, TheLargestWindowsAreCountedWhole) {
  // Given more of the far depth in the last rows than a shorter buffer would hold
  SurfaceDepthOptions options = fixedOptions();
  options.own_radius = 25;
  const Drawing drawing(51, 51, [](int, int r) { return r < 25 ? 2.0f : 4.0f; });
  EXPECT_EQ(ask(drawing, 25.0f, 25.0f, options).depth, 4.0f);  // 26 of 51 rows
  options.own_radius = 0;
  options.wide_radius = 50;
  const Drawing wide(101, 101, [](int, int r) { return r < 52 ? r > 48 ? 0.0f : 2.0f : 4.0f; });
  const Answer answer = ask(wide, 50.0f, 50.0f, options);  // 25 rows near, 25 far of 51
  EXPECT_EQ(answer.support, SurfaceSupport::kBehind);
  EXPECT_EQ(answer.depth, 4.0f);
}

TEST(SurfaceDepth, PaddingBetweenRowsIsNotLookedAt) {
  // Given rows of 41 pixels at 4 m, and 9 of padding at 1 m
  const Drawing padded(50, 41, [](int c, int) { return c < 41 ? 4.0f : 1.0f; });
  const DepthImageView view{padded.pixels.data(), 41, 41, 50};
  const std::vector<float> u{40.0f, 0.0f};
  const std::vector<float> v{20.0f, 20.0f};
  const SurfaceDepths depths = surfaceDepths(view, u, v, fixedOptions());
  EXPECT_EQ(depths.depth, (std::vector<float>{4.0f, 4.0f}));
  EXPECT_EQ(depths.is_dragged, (std::vector<std::uint8_t>{0, 0}));
}

TEST(SurfaceDepth, ReusedMemoryChangesNothing) {
  const Drawing drawing = edge(2.0f, 0.0f, 4.0f);
  const std::vector<float> u{5.0f, 20.0f, 30.0f, kNaN};
  const std::vector<float> v{5.0f, 20.0f, 30.0f, 1.0f};
  const SurfaceDepths fresh = surfaceDepths(drawing.view(), u, v, fixedOptions());
  SurfaceDepths used;
  used.depth.assign(9, 7.0f);
  used.support.assign(2, SurfaceSupport::kBeside);
  used.is_dragged.assign(5, 1);
  const SurfaceDepths reused = surfaceDepths(drawing.view(), u, v, fixedOptions(), std::move(used));
  EXPECT_EQ(reused.depth, fresh.depth);
  EXPECT_EQ(reused.support, fresh.support);
  EXPECT_EQ(reused.is_dragged, fresh.is_dragged);
  EXPECT_EQ(fresh.support,
            (std::vector<SurfaceSupport>{SurfaceSupport::kMeasured, SurfaceSupport::kBehind,
                                         SurfaceSupport::kMeasured, SurfaceSupport::kNone}));
  EXPECT_TRUE(surfaceDepths(drawing.view(), {}, {}, fixedOptions()).depth.empty());
}

TEST(SurfaceDepth, BadImagesAndUnequalArraysAreRefused) {
  const Drawing drawing([](int, int) { return 2.0f; });
  const std::vector<float> one{1.0f};
  const auto message = [&](const DepthImageView& image, Span<const float> v) {
    return test::invalidArgumentOf([&] { surfaceDepths(image, one, v, fixedOptions()); });
  };
  EXPECT_EQ(message({}, one),
            "surfaceDepths: depth image of 0 x 0, stride 0; expected pixels and a stride of at "
            "least the width");
  EXPECT_EQ(message({drawing.pixels.data(), 41, 41, 40}, one),
            "surfaceDepths: depth image of 41 x 41, stride 40; expected pixels and a stride of at "
            "least the width");
  EXPECT_EQ(message(drawing.view(), {}),
            "surfaceDepths: 1 columns, but 0 rows; expected equal sizes");
  EXPECT_EQ(message(drawing.view(), one), "nothing thrown");
}

TEST(SurfaceDepth, OptionsOutOfRangeAreNamed) {
  const auto message = [](auto change) {
    SurfaceDepthOptions options = fixedOptions();
    change(options);
    return test::invalidArgumentOf([&] { checkOptions(options); });
  };
  using Options = SurfaceDepthOptions;
  EXPECT_EQ(message([](Options& o) { o.own_radius = 26; }),
            "SurfaceDepthOptions::own_radius is 26.000000; expected a radius in [0, 25] (px)");
  EXPECT_EQ(message([](Options& o) { o.wide_radius = -1; }),
            "SurfaceDepthOptions::wide_radius is -1.000000; expected a radius in [0, 50] (px)");
  EXPECT_EQ(message([](Options& o) { o.flow_radius = 251; }),
            "SurfaceDepthOptions::flow_radius is 251.000000; expected a radius in [0, 250] (px)");
  EXPECT_EQ(message([](Options& o) { o.own_share = 0.0f; }),
            "SurfaceDepthOptions::own_share is 0.000000; expected a share in (0, 1]");
  EXPECT_EQ(message([](Options& o) { o.enclosed_share = kNaN; }),
            "SurfaceDepthOptions::enclosed_share is nan; expected a share in (0, 1]");
  EXPECT_EQ(message([](Options& o) { o.behind_share = 1.5f; }),
            "SurfaceDepthOptions::behind_share is 1.500000; expected a share in (0, 1]");
  EXPECT_EQ(message([](Options& o) { o.gap_floor = -0.5f; }),
            "SurfaceDepthOptions::gap_floor is -0.500000; expected a finite value >= 0 (m)");
  EXPECT_EQ(message([](Options& o) { o.gap_quadratic = kInfinity; }),
            "SurfaceDepthOptions::gap_quadratic is inf; expected a finite value >= 0 (1/m)");
  EXPECT_EQ(message([](Options&) {}), "nothing thrown");
}

TEST(SurfaceDepth, SupportsHaveNames) {
  EXPECT_STREQ(toString(SurfaceSupport::kMeasured), "measured");
  EXPECT_STREQ(toString(SurfaceSupport::kEnclosed), "enclosed");
  EXPECT_STREQ(toString(SurfaceSupport::kBehind), "behind");
  EXPECT_STREQ(toString(SurfaceSupport::kBeside), "beside");
  EXPECT_STREQ(toString(SurfaceSupport::kNone), "none");
}

}  // namespace
}  // namespace hmcdyn

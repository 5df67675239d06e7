// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include <hmcdyn/surface_depth.hpp>

#include "invalid_argument.hpp"

namespace hmcdyn {
namespace {

/// A depth image that is painted in rectangles.
class Painting {
 public:
  Painting(int width, int height, float depth)
      : width_(width),
        height_(height),
        data_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), depth) {}

  /// Columns from .. to - 1 of all rows.
  Painting& columns(int from, int to, float depth) {
    for (int row = 0; row < height_; ++row) {
      for (int column = from; column < to; ++column) {
        at(column, row) = depth;
      }
    }
    return *this;
  }
  float& at(int column, int row) {
    return data_[static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
                 static_cast<std::size_t>(column)];
  }
  DepthImageView view() const {
    return {data_.data(), width_, height_, static_cast<std::size_t>(width_)};
  }

  SurfaceDepths look(float u, float v, const SurfaceDepthOptions& options = {}) const {
    const std::vector<float> us{u};
    const std::vector<float> vs{v};
    return surfaceDepths(view(), us, vs, options);
  }

 private:
  int width_;
  int height_;
  std::vector<float> data_;
};

TEST(SurfaceDepth, IsTheMedianOfThePointsOwnWindow) {
  // Given 3 x 3 depths 1.1 .. 1.9, one of them missing
  Painting painting(9, 9, 0.0f);
  float depth = 1.1f;
  for (int row = 3; row < 6; ++row) {
    for (int column = 3; column < 6; ++column) {
      painting.at(column, row) = depth;
      depth += 0.1f;
    }
  }
  painting.at(3, 3) = 0.0f;
  SurfaceDepthOptions options;
  options.own_radius = 1;
  // Then of 1.2 .. 1.9 the upper middle one, 1.6, is the surface's.
  const SurfaceDepths found = painting.look(4.0f, 4.0f, options);
  EXPECT_EQ(found.support[0], SurfaceSupport::kMeasured);
  EXPECT_NEAR(found.depth[0], 1.6f, 1e-6f);
}

TEST(SurfaceDepth, AHoleInANearSurfaceIsEnclosedByIt) {
  const Painting painting = Painting(60, 40, 2.0f).columns(27, 34, 0.0f);
  const SurfaceDepths found = painting.look(30.0f, 20.0f);
  EXPECT_EQ(found.support[0], SurfaceSupport::kEnclosed);
  EXPECT_FLOAT_EQ(found.depth[0], 2.0f);
  EXPECT_EQ(found.is_dragged[0], 0);
}

TEST(SurfaceDepth, AShadowBesideAnEdgeLiesOnTheFartherSurface) {
  // A person up to column 29, their shadow up to 39, the wall behind it.
  const Painting painting = Painting(80, 40, 3.5f).columns(0, 30, 2.0f).columns(30, 40, 0.0f);
  const SurfaceDepths found = painting.look(35.0f, 20.0f);
  EXPECT_EQ(found.support[0], SurfaceSupport::kBehind);
  EXPECT_FLOAT_EQ(found.depth[0], 3.5f);
  EXPECT_EQ(found.is_dragged[0], 1) << "the person is within the flow's window";
}

TEST(SurfaceDepth, BesideANearSurfaceWithNothingBehindItTheDepthStaysUnknown) {
  const Painting painting = Painting(80, 40, 0.0f).columns(0, 30, 2.0f);
  const SurfaceDepths found = painting.look(36.0f, 20.0f);
  EXPECT_EQ(found.support[0], SurfaceSupport::kBeside);
  EXPECT_FLOAT_EQ(found.depth[0], 0.0f);
  EXPECT_EQ(found.is_dragged[0], 1);
}

TEST(SurfaceDepth, OutOfTheSensorsRangeThereIsNone) {
  const SurfaceDepths found = Painting(80, 40, 0.0f).look(40.0f, 20.0f);
  EXPECT_EQ(found.support[0], SurfaceSupport::kNone);
  EXPECT_FLOAT_EQ(found.depth[0], 0.0f);
  EXPECT_EQ(found.is_dragged[0], 0);
}

TEST(SurfaceDepth, OnlyTheFartherSideOfAnEdgeIsDragged) {
  const Painting painting = Painting(80, 40, 3.5f).columns(0, 30, 2.0f);
  EXPECT_EQ(painting.look(25.0f, 20.0f).is_dragged[0], 0) << "on the person";
  EXPECT_EQ(painting.look(35.0f, 20.0f).is_dragged[0], 1) << "5 px beside";
  EXPECT_EQ(painting.look(45.0f, 20.0f).is_dragged[0], 0) << "beyond the flow's window";
}

TEST(SurfaceDepth, ASlopeWithinTheGapIsOneSurface) {
  // At 2 m surfaces differ from 0.1 + 0.03 * 4 = 0.22 m on.
  const Painting painting = Painting(80, 40, 2.2f).columns(0, 30, 2.0f);
  EXPECT_EQ(painting.look(32.0f, 20.0f).is_dragged[0], 0);
}

TEST(SurfaceDepth, PointsOutsideTheImageOrNotFiniteHaveNone) {
  const Painting painting(20, 10, 1.0f);
  for (const float u : {-1.0f, 19.6f, kNaN, std::numeric_limits<float>::infinity()}) {
    EXPECT_EQ(painting.look(u, 5.0f).support[0], SurfaceSupport::kNone) << u;
  }
  EXPECT_EQ(painting.look(19.4f, 9.4f).support[0], SurfaceSupport::kMeasured) << "in the corner";
  EXPECT_EQ(painting.look(-0.4f, -0.4f).support[0], SurfaceSupport::kMeasured);
}

TEST(SurfaceDepth, DepthsThatAreNoneDoNotCount) {
  Painting painting(20, 20, 1.5f);
  painting.at(10, 10) = kNaN;
  painting.at(9, 10) = -1.0f;
  EXPECT_FLOAT_EQ(painting.look(10.0f, 10.0f).depth[0], 1.5f);
}

TEST(SurfaceDepth, MistakesOfTheCallerAreNamed) {
  const Painting painting(20, 10, 1.0f);
  const std::vector<float> one{1.0f};
  const std::vector<float> two{1.0f, 2.0f};
  const auto message = [&](const DepthImageView& image, Span<const float> v,
                           const SurfaceDepthOptions& options) {
    return test::invalidArgumentOf([&] { surfaceDepths(image, one, v, options); });
  };
  EXPECT_NE(message({}, one, {}).find("expected pixels"), std::string::npos);
  DepthImageView narrow = painting.view();
  narrow.stride = 19;
  EXPECT_NE(message(narrow, one, {}).find("stride 19"), std::string::npos);
  EXPECT_NE(message(painting.view(), two, {}).find("2 rows"), std::string::npos);
  SurfaceDepthOptions options;
  options.enclosed_share = 1.5f;
  EXPECT_NE(message(painting.view(), one, options).find("enclosed_share is 1.5"),
            std::string::npos);
}

}  // namespace
}  // namespace hmcdyn

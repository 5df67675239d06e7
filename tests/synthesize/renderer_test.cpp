// SPDX-License-Identifier: BSD-3-Clause
#include "synthesize/renderer.hpp"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "test_scenes.hpp"

namespace hmcdyn::synthesize {
namespace {

using test::frontalQuad;
using test::plainScene;
using test::smallImage;

TEST(Renderer, WallAcrossTheViewHasItsDistanceAsDepthEverywhere) {
  Scene scene = plainScene();
  scene.room.push_back(frontalQuad(0.0f, 2.0f, 0.0f, 8.0f, 8.0f, 0));
  const RenderedFrame frame = Renderer(scene, smallImage()).render(0.0);
  for (int v = 0; v < frame.depth.rows; ++v) {
    for (int u = 0; u < frame.depth.cols; ++u) {
      ASSERT_FLOAT_EQ(frame.depth.at<float>(v, u), 2.0f) << "at (" << u << ", " << v << ")";
    }
  }
}

TEST(Renderer, DepthOfAFloorFollowsItsClosedForm) {
  // Floor 1.5 m below the camera, reaching behind it: z = 1.5 fy / (v - cy) below the horizon.
  Scene scene = plainScene();
  Mesh floor;
  addQuad(floor, {-20, 20, -1.5f}, {40, 0, 0}, {0, -40, 0}, {0, 1.0f, {0, 0}, {1, 1}}, 0.7f);
  scene.room.push_back(litStill(std::move(floor), Lighting{}));
  const RenderOptions options = smallImage();
  const RenderedFrame frame = Renderer(scene, options).render(0.0);
  for (int v = 0; v < options.height; ++v) {
    const double expected =
        v > options.camera.cy ? 1.5 * options.camera.fy / (v - options.camera.cy) : 0.0;
    for (int u = 0; u < options.width; u += 5) {
      if (expected > 19.0) {
        continue;  // beyond the floor's end
      }
      ASSERT_NEAR(static_cast<double>(frame.depth.at<float>(v, u)), expected, 2e-6 * expected)
          << "at (" << u << ", " << v << ")";
    }
  }
}

TEST(Renderer, NearerSurfaceHidesTheFartherAndItsBorderIsWhereItProjects) {
  // A quad of 0.4 m at 1 m spans 40 px: columns 20..60 and rows 10..50 around (40, 30).
  Scene scene = plainScene();
  scene.room.push_back(frontalQuad(0.0f, 3.0f, 0.0f, 8.0f, 8.0f, 0));
  scene.room.push_back(frontalQuad(0.001f, 1.0f, 0.001f, 0.4f, 0.4f, 1));
  const RenderedFrame frame = Renderer(scene, smallImage()).render(0.0);
  EXPECT_FLOAT_EQ(frame.depth.at<float>(30, 20), 3.0f);
  EXPECT_FLOAT_EQ(frame.depth.at<float>(30, 21), 1.0f);
  EXPECT_FLOAT_EQ(frame.depth.at<float>(30, 60), 1.0f);
  EXPECT_FLOAT_EQ(frame.depth.at<float>(30, 61), 3.0f);
  EXPECT_FLOAT_EQ(frame.depth.at<float>(9, 40), 3.0f);
  EXPECT_FLOAT_EQ(frame.depth.at<float>(10, 40), 1.0f);
  EXPECT_FLOAT_EQ(frame.depth.at<float>(49, 40), 1.0f);
  EXPECT_FLOAT_EQ(frame.depth.at<float>(50, 40), 3.0f);
}

TEST(Renderer, NothingMetIsDepthZeroAndBlack) {
  const Scene scene = plainScene();
  const RenderedFrame frame = Renderer(scene, smallImage()).render(0.0);
  EXPECT_EQ(cv::countNonZero(frame.depth), 0);
  EXPECT_EQ(cv::countNonZero(frame.color.reshape(1)), 0);
}

TEST(Renderer, SurfaceIsInvisibleFromBehind) {
  Scene scene = plainScene();
  Mesh mesh;
  addQuad(mesh, {1, 2, 1}, {-2, 0, 0}, {0, 0, -2}, {});
  scene.room.push_back(litStill(std::move(mesh), Lighting{}));
  EXPECT_EQ(cv::countNonZero(Renderer(scene, smallImage()).render(0.0).depth), 0);
}

TEST(Renderer, ColourSitsWhereTheSurfaceIs) {
  // White left of x = 0, black right of it: the border projects to column 40, and the pixel that it
  // halves has half of the white.
  Scene scene = plainScene();
  scene.room.push_back(frontalQuad(-4.0f, 2.0f, 0.0f, 8.0f, 8.0f, 0));
  scene.room.push_back(frontalQuad(4.0f, 2.0f, 0.0f, 8.0f, 8.0f, 1));
  const RenderedFrame frame = Renderer(scene, smallImage()).render(0.0);
  EXPECT_EQ(frame.color.at<cv::Vec3b>(30, 39)[1], 200);
  EXPECT_EQ(frame.color.at<cv::Vec3b>(30, 40)[1], 100);
  EXPECT_EQ(frame.color.at<cv::Vec3b>(30, 41)[1], 0);
}

TEST(Renderer, FacingIsTheCosineToTheNormal) {
  Scene scene = plainScene();
  scene.room.push_back(frontalQuad(0.0f, 2.0f, 0.0f, 8.0f, 8.0f, 0));
  const RenderedFrame frame = Renderer(scene, smallImage()).render(0.0);
  EXPECT_NEAR(frame.facing.at<float>(30, 40), 1.0f, 1e-6f);
  EXPECT_NEAR(frame.facing.at<float>(30, 80), 1.0f / std::hypot(1.0f, 0.4f), 1e-6f);
}

TEST(Renderer, MaskTellsMovingFromStandingByTheSurfacesSpeed) {
  Scene scene = plainScene();
  scene.room.push_back(frontalQuad(0.0f, 3.0f, 0.0f, 8.0f, 8.0f, 0));
  const LitMesh part = frontalQuad(0.0f, 0.0f, 0.0f, 0.2f, 0.2f, 1);
  scene.movers.push_back(
      test::moverOf(part, [](double t) { return test::shifted(-0.2 + 0.012 * t, 1.0, 0.0); }));
  scene.movers.push_back(
      test::moverOf(part, [](double t) { return test::shifted(0.2 + 0.008 * t, 1.0, 0.0); }));
  RenderOptions options = smallImage();
  options.moving_speed = 0.01;
  const RenderedFrame frame = Renderer(scene, options).render(0.0);
  EXPECT_EQ(frame.mask.at<std::uint8_t>(30, 40), kMaskStatic);
  EXPECT_EQ(frame.mask.at<std::uint8_t>(30, 20), kMaskMoving);
  EXPECT_EQ(frame.mask.at<std::uint8_t>(30, 60), kMaskStanding);
  EXPECT_EQ(frame.mover.at<std::int16_t>(30, 40), -1);
  EXPECT_EQ(frame.mover.at<std::int16_t>(30, 20), 0);
  EXPECT_EQ(frame.mover.at<std::int16_t>(30, 60), 1);
}

TEST(Renderer, TurningPartMovesAtItsRimAndRestsAtItsHub) {
  // 0.2 rad/s around the view axis: faster than 0.01 m/s beyond 0.05 m, which is 5 px at 1 m.
  Scene scene = plainScene();
  scene.movers.push_back(test::moverOf(frontalQuad(0.0f, 0.0f, 0.0f, 0.4f, 0.4f, 0), [](double t) {
    Eigen::Isometry3d pose = test::shifted(0.0, 1.0, 0.0);
    pose.rotate(Eigen::AngleAxisd(0.2 * t, Eigen::Vector3d::UnitY()));
    return pose;
  }));
  const RenderedFrame frame = Renderer(scene, smallImage()).render(1.0);
  for (int u = 25; u <= 55; ++u) {
    const int from_hub = std::abs(u - 40);
    if (from_hub != 5) {
      EXPECT_EQ(frame.mask.at<std::uint8_t>(30, u), from_hub > 5 ? kMaskMoving : kMaskStanding)
          << "column " << u;
    }
  }
}

TEST(Renderer, ExposureBlursByTheWayOfTheSurface) {
  // 4 m/s at 1 m and 100 px focal length is 400 px/s: 8 px in 0.02 s, around the still place.
  Scene scene = plainScene();
  scene.lighting.ambient = 1.0f;
  scene.lighting.sky = 0.0f;
  scene.lighting.window = 0.0f;
  scene.movers.push_back(test::moverOf(frontalQuad(0.0f, 0.0f, 0.0f, 0.3f, 4.0f, 0),
                                       [](double t) { return test::shifted(4.0 * t, 1.0, 0.0); }));
  RenderOptions options = smallImage();
  const RenderedFrame sharp = Renderer(scene, options).render(0.0);
  options.exposure = 0.02;
  const RenderedFrame blurred = Renderer(scene, options).render(0.0);
  const auto partial = [](const RenderedFrame& frame) {
    int count = 0;
    for (int u = 0; u < frame.color.cols; ++u) {
      const int level = frame.color.at<cv::Vec3b>(30, u)[1];
      count += level > 5 && level < 195 ? 1 : 0;
    }
    return count;
  };
  EXPECT_LE(partial(sharp), 2);
  EXPECT_GE(partial(blurred), 10);  // two borders, 8 px less the outer halves of the samples each
  EXPECT_LE(partial(blurred), 18);
  EXPECT_NEAR(cv::sum(blurred.color.row(30))[1], cv::sum(sharp.color.row(30))[1], 200.0);
  EXPECT_EQ(cv::norm(sharp.depth, blurred.depth, cv::NORM_INF), 0.0);
}

TEST(Renderer, RefusesImpossibleOptions) {
  const Scene scene = plainScene();
  RenderOptions options = smallImage();
  options.width = 0;
  EXPECT_THROW(Renderer(scene, options), std::invalid_argument);
  options = smallImage();
  options.camera.fx = 0.0;
  EXPECT_THROW(Renderer(scene, options), std::invalid_argument);
  options = smallImage();
  options.exposure = -0.1;
  EXPECT_THROW(Renderer(scene, options), std::invalid_argument);
}

}  // namespace
}  // namespace hmcdyn::synthesize

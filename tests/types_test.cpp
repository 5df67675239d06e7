// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <hmcdyn/types.hpp>

namespace hmcdyn {
namespace {

TEST(Types, DepthIsUsableOnlyWhenFiniteAndPositive) {
  EXPECT_TRUE(hasDepth(0.5f));
  EXPECT_FALSE(hasDepth(0.0f));
  EXPECT_FALSE(hasDepth(-1.0f));
  EXPECT_FALSE(hasDepth(kNaN));
  EXPECT_FALSE(hasDepth(std::numeric_limits<float>::infinity()));
}

TEST(Types, UnequalArraysAreRefusedWithTheirSizes) {
  KeyPoints points;
  points.push_back(1.0f, 2.0f, 3.0f);
  points.depth.pop_back();
  try {
    checkKeyPoints(points.view());
    FAIL() << "expected std::invalid_argument";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "key points: u has 1 elements, v 1, depth 0; expected equal sizes");
  }
}

TEST(Types, InvertedAndNaNBoxesHoldNoPoint) {
  EXPECT_TRUE((DetectionBox{0, 0, 10, 10}).contains(10, 0));
  EXPECT_FALSE((DetectionBox{10, 0, 0, 10}).contains(5, 5));
  EXPECT_FALSE((DetectionBox{0, 0, kNaN, 10}).contains(5, 5));
  EXPECT_FALSE((DetectionBox{0, 0, 10, 10}).contains(kNaN, 5));
}

TEST(Types, UnprojectInvertsProject) {
  const PinholeCamera camera{535.4, 539.2, 320.1, 247.6};
  const Eigen::Vector3d point(0.3, -0.2, 2.5);
  const Eigen::Vector2d pixel = camera.project(point);
  EXPECT_NEAR(pixel.x(), 535.4 * 0.3 / 2.5 + 320.1, 1e-12);
  EXPECT_TRUE(camera.unproject(pixel.x(), pixel.y(), 2.5).isApprox(point, 1e-12));
}

}  // namespace
}  // namespace hmcdyn

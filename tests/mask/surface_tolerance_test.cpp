// SPDX-License-Identifier: BSD-3-Clause
#include "mask/surface_tolerance.hpp"

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

namespace hmcdyn::internal {
namespace {

constexpr SmallCamera kCamera = {133.0f, 133.0f, 80.0f, 60.0f};
constexpr float kWall = 2.0f;  // (m)

/// A wall in front of the camera, with noise of so many times the model's.
SmallFrame wall(float noise, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  const float sigma = depthNoise(kWall, DepthErrorModel{}) * noise;
  MotionMaskFrame frame;
  frame.depth.create(120, 160, CV_32FC1);
  for (int y = 0; y < frame.depth.rows; ++y) {
    for (int x = 0; x < frame.depth.cols; ++x) {
      frame.depth.at<float>(y, x) = kWall + sigma * normal(random);
    }
  }
  ReduceWorkspace workspace;
  return reduceFrame(frame, 1, {}, workspace);
}

float measured(const SmallFrame& frame, const SmallFrame& earlier) {
  std::vector<float> errors;
  return measuredNoise(frame, earlier, kCamera, relativePose(Pose{}, Pose{}), {}, errors);
}

TEST(MeasuredNoise, IsWhatWasAdded) {
  for (const float noise : {0.6f, 1.0f, 2.0f}) {
    EXPECT_NEAR(measured(wall(noise, 1), wall(noise, 2)), noise, 0.08f * noise) << noise;
  }
}

TEST(MeasuredNoise, ThingsInFrontDoNotCount) {
  SmallFrame frame = wall(1.0f, 1);
  for (std::size_t i = 0; i < frame.size() / 2; ++i) {
    frame.depth[i] = 1.2f;  // a person who has come since
  }
  EXPECT_NEAR(measured(frame, wall(1.0f, 2)), 1.0f, 0.1f);
}

TEST(MeasuredNoise, WhatWasBelievedToMoveDoesNotCount) {
  SmallFrame earlier = wall(1.0f, 2);
  SmallFrame frame = wall(1.0f, 1);
  for (std::size_t i = 0; i < earlier.size(); i += 2) {
    earlier.cells[i].belief = 0.5f;
    frame.depth[i] += 0.06f;  // half of all pixels come nearer by several sigma
  }
  EXPECT_NEAR(measured(frame, earlier), 1.0f, 0.1f);
}

TEST(MeasuredNoise, IsBounded) {
  EXPECT_FLOAT_EQ(measured(wall(0.0f, 1), wall(0.0f, 2)), 0.4f);
  SmallFrame shifted = wall(1.0f, 1);
  for (float& z : shifted.depth) {
    z += 0.1f;
  }
  EXPECT_FLOAT_EQ(measured(shifted, wall(1.0f, 2)), 4.0f);
}

TEST(MeasuredNoise, IsTheModelsWhereTooLittleIsSeen) {
  SmallFrame frame = wall(2.0f, 1);
  for (std::size_t i = 100; i < frame.size(); ++i) {
    frame.depth[i] = 0.0f;
  }
  EXPECT_FLOAT_EQ(measured(frame, wall(2.0f, 2)), 1.0f);
}

TEST(SurfaceTolerance, GrowsWithNoiseAndRange) {
  MaskModel model;
  model.depth.gate = 3.0f;
  model.depth.slack = 0.01f;
  model.options.depth_error.noise_floor = 0.001f;
  model.options.depth_error.noise_quadratic = 0.002f;
  model.options.depth_error.systematic_linear = 0.005f;
  model.options.depth_error.systematic_quadratic = 0.003f;
  // at 2 m: 0.01 + 3 sqrt(2) noise (0.001 + 0.008) + 0.01 + 0.012
  EXPECT_NEAR(surfaceTolerance(model, 1.0f).at(2.0f), 0.032f + 0.038184f, 1e-5f);
  EXPECT_NEAR(surfaceTolerance(model, 0.5f).at(2.0f), 0.032f + 0.019092f, 1e-5f);
}

TEST(ReducedDepth, IsTheMeanOfOneSurface) {
  MotionMaskFrame frame;
  frame.depth = cv::Mat(64, 64, CV_32FC1, cv::Scalar(2.0));
  frame.depth.at<float>(10, 10) = 2.04f;  // square 2, 2, whose middle it is
  frame.depth.at<float>(9, 9) = 1.0f;     // another surface
  frame.depth.at<float>(8, 8) = 0.0f;     // not measured
  frame.depth.at<float>(8, 9) = std::nanf("");
  ReduceWorkspace workspace;
  const SmallFrame small = reduceFrame(frame, 4, {}, workspace);
  EXPECT_NEAR(small.depth[small.index(2, 2)], (12.0f * 2.0f + 2.04f) / 13.0f, 1e-5f);
  EXPECT_FLOAT_EQ(small.depth[small.index(3, 3)], 2.0f);
  EXPECT_FLOAT_EQ(small.depth_share, 1.0f);
}

}  // namespace
}  // namespace hmcdyn::internal

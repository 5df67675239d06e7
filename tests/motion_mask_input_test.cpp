// SPDX-License-Identifier: BSD-3-Clause
// What the motion mask makes of bad input: a defined mask with its reason.
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <hmcdyn/motion_mask.hpp>

#include "invalid_argument.hpp"
#include "sliding_thing.hpp"

namespace hmcdyn {
namespace {

using test::shareOf;
using test::SlidingThing;

constexpr double kStep = 1.0 / 30.0;  // (s)

/// The board moves at 0.5 m/s.
SlidingThing sceneAt(double t) { return {t, 0.0, -0.6 + 0.5 * t}; }

template <class Call>
void expectRefused(Call&& call, const std::string& name) {
  EXPECT_NE(test::invalidArgumentOf(call).find(name), std::string::npos) << name;
}

bool isAllUnknown(const MotionMask& mask) {
  return cv::countNonZero(mask.label != static_cast<int>(MaskLabel::kUnknown)) == 0 &&
         mask.instances.empty();
}

/// An estimator that has seen 20 frames; the next is due at 20 * kStep.
MotionMaskEstimator experienced() {
  MotionMaskEstimator estimator(SlidingThing::kCamera);
  for (int k = 0; k < 20; ++k) {
    estimator.update(sceneAt(k * kStep).frame());
  }
  return estimator;
}

TEST(MotionMaskInput, TheFirstFrameIsUnknown) {
  MotionMaskEstimator estimator(SlidingThing::kCamera);
  const SlidingThing scene = sceneAt(0.0);
  const MotionMask& mask = estimator.update(scene.frame());
  EXPECT_EQ(mask.state, MaskState::kFirstFrame);
  EXPECT_TRUE(isAllUnknown(mask));
}

TEST(MotionMaskInput, AnUnknownMotionLeavesOneFrameOut) {
  MotionMaskEstimator estimator = experienced();
  SlidingThing scene = sceneAt(20 * kStep);
  scene.frame().pose_is_known = false;
  EXPECT_EQ(estimator.update(scene.frame()).state, MaskState::kMotionUnknown);
  SlidingThing not_finite = sceneAt(21 * kStep);
  not_finite.frame().camera_from_world.matrix(0, 3) = std::numeric_limits<double>::quiet_NaN();
  const MotionMask& mask = estimator.update(not_finite.frame());
  EXPECT_EQ(mask.state, MaskState::kMotionUnknown);
  EXPECT_TRUE(isAllUnknown(mask));
  // Then the next one is judged by what was remembered
  const SlidingThing next = sceneAt(22 * kStep);
  const MotionMask& judged = estimator.update(next.frame());
  EXPECT_EQ(judged.state, MaskState::kGood);
  EXPECT_GT(shareOf(judged.label, MaskLabel::kMoving, next.truth()), 0.9);
}

TEST(MotionMaskInput, AFrameWithoutDepthIsLeftOut) {
  MotionMaskEstimator estimator = experienced();
  for (const float nothing : {0.0f, -1.0f, std::numeric_limits<float>::quiet_NaN(),
                              std::numeric_limits<float>::infinity()}) {
    SlidingThing scene = sceneAt(20 * kStep);
    scene.frame().depth.setTo(nothing);
    const MotionMask& mask = estimator.update(scene.frame());
    EXPECT_EQ(mask.state, MaskState::kNoDepth);
    EXPECT_TRUE(isAllUnknown(mask));
  }
  EXPECT_EQ(estimator.update(sceneAt(21 * kStep).frame()).state, MaskState::kGood);
}

TEST(MotionMaskInput, TheHalfWithoutDepthIsUnknown) {
  MotionMaskEstimator estimator = experienced();
  SlidingThing scene = sceneAt(20 * kStep);
  const cv::Rect right(SlidingThing::kWidth / 2, 0, SlidingThing::kWidth / 2,
                       SlidingThing::kHeight);
  scene.frame().depth(right) = 0.0f;
  const MotionMask& mask = estimator.update(scene.frame());
  EXPECT_EQ(mask.state, MaskState::kGood);
  EXPECT_EQ(cv::countNonZero(mask.label(right) != 64), 0);
}

TEST(MotionMaskInput, TimeThatJumpsForgetsAllBefore) {
  for (const double stamp : {19 * kStep, 5 * kStep, 30.0}) {  // again, back, far ahead
    MotionMaskEstimator estimator = experienced();
    const MotionMask& mask = estimator.update(sceneAt(stamp).frame());
    EXPECT_EQ(mask.state, MaskState::kTimeJump) << stamp;
    EXPECT_TRUE(isAllUnknown(mask)) << stamp;
    EXPECT_EQ(estimator.update(sceneAt(stamp + kStep).frame()).state, MaskState::kGood) << stamp;
  }
}

TEST(MotionMaskInput, ACameraThatJumpsForgetsAllBefore) {
  MotionMaskEstimator estimator = experienced();
  SlidingThing scene = sceneAt(20 * kStep);
  scene.frame().camera_from_world.matrix(2, 3) = -0.6;  // m along z
  const MotionMask& mask = estimator.update(scene.frame());
  EXPECT_EQ(mask.state, MaskState::kCameraJump);
  EXPECT_TRUE(isAllUnknown(mask));
}

TEST(MotionMaskInput, AWrongMotionIsNotTakenForAThing) {
  // Given a pose that is 0.3 m too near to the wall: all of the room seems to have come
  MotionMaskEstimator estimator = experienced();
  SlidingThing scene = sceneAt(20 * kStep);
  scene.frame().camera_from_world.matrix(2, 3) = 0.3;
  const MotionMask& mask = estimator.update(scene.frame());
  EXPECT_EQ(mask.state, MaskState::kMotionDoubtful);
  EXPECT_LT(mask.agreement, 0.5f);
  EXPECT_TRUE(isAllUnknown(mask));
}

TEST(MotionMaskInput, AnotherSizeStartsAnew) {
  MotionMaskEstimator estimator = experienced();
  MotionMaskFrame frame;
  frame.timestamp = 20 * kStep;
  frame.depth = cv::Mat(90, 163, CV_32FC1, cv::Scalar(2.0));
  const MotionMask& mask = estimator.update(frame);
  EXPECT_EQ(mask.state, MaskState::kFirstFrame);
  EXPECT_EQ(mask.label.size(), frame.depth.size());
  EXPECT_TRUE(isAllUnknown(mask));
}

TEST(MotionMaskInput, ResetForgetsAllBefore) {
  MotionMaskEstimator estimator = experienced();
  estimator.reset();
  EXPECT_EQ(estimator.update(sceneAt(20 * kStep).frame()).state, MaskState::kFirstFrame);
}

TEST(MotionMaskInput, BoxesOutsideTheImageOrNotFiniteNameNothing) {
  MotionMaskEstimator estimator = experienced();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<DetectionBox> boxes = {{-500.0f, -500.0f, -100.0f, -100.0f},
                                           {1e9f, 0.0f, 2e9f, 50.0f},
                                           {nan, 0.0f, 100.0f, 100.0f},
                                           {100.0f, 100.0f, 50.0f, 50.0f}};
  SlidingThing scene = sceneAt(20 * kStep);
  scene.frame().regions = boxes;
  EXPECT_EQ(cv::countNonZero(estimator.update(scene.frame()).label == 128), 0);
}

TEST(MotionMaskInput, ImagesThatDoNotFitAreRefusedByName) {
  MotionMaskEstimator estimator(SlidingThing::kCamera);
  const auto refused = [&](const char* name, auto change) {
    SlidingThing scene = sceneAt(0.0);
    change(scene.frame());
    expectRefused([&] { estimator.update(scene.frame()); }, name);
  };
  refused("depth", [](MotionMaskFrame& frame) { frame.depth = cv::Mat(); });
  refused("depth", [](MotionMaskFrame& frame) { frame.depth = cv::Mat(120, 160, CV_16UC1); });
  refused("depth", [](MotionMaskFrame& frame) { frame.depth = cv::Mat(15, 160, CV_32FC1); });
  refused("gray", [](MotionMaskFrame& frame) { frame.gray = cv::Mat(120, 161, CV_8UC1); });
  refused("gray", [](MotionMaskFrame& frame) { frame.gray = cv::Mat(120, 160, CV_8UC3); });
  refused("labels",
          [](MotionMaskFrame& frame) { frame.regions.labels = cv::Mat(60, 80, CV_8UC1); });
  const std::vector<PointLabel> verdicts(1);
  refused("verdicts", [&](MotionMaskFrame& frame) { frame.verdicts = verdicts; });
}

TEST(MotionMaskInput, OptionsOutOfRangeAreRefusedByName) {
  const auto refused = [](const char* name, auto change) {
    MotionMaskOptions options;
    change(options);
    expectRefused([&] { checkOptions(options); }, name);
  };
  refused("working_width", [](MotionMaskOptions& o) { o.working_width = 8; });
  refused("max_moving_share", [](MotionMaskOptions& o) { o.max_moving_share = 1.5f; });
  refused("max_depth", [](MotionMaskOptions& o) { o.max_depth = 0.0f; });
  refused("noise_floor", [](MotionMaskOptions& o) { o.depth_error.noise_floor = -1.0f; });
  refused("gray_tolerance", [](MotionMaskOptions& o) { o.gray_tolerance = -1.0f; });
  refused("min_area", [](MotionMaskOptions& o) { o.min_area = 2.0f; });
  refused("max_age", [](MotionMaskOptions& o) { o.max_age = -1.0; });
  refused("max_gap", [](MotionMaskOptions& o) { o.max_gap = 0.0; });
  expectRefused([] { MotionMaskEstimator estimator(PinholeCamera{}); }, "fx");
}

}  // namespace
}  // namespace hmcdyn

// SPDX-License-Identifier: BSD-3-Clause
// What refinePose() refuses.
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <hmcdyn/pose_refinement.hpp>

#include "pose_scene.hpp"

namespace hmcdyn {
namespace {

struct Call {
  test::PoseScene scene = test::makePoseScene(1, 10);
  Eigen::Isometry3d initial = scene.camera_from_world;
  PoseRefinementOptions options;
};

std::string refusalOf(const std::function<void(Call&)>& spoil) {
  Call call;
  spoil(call);
  try {
    refinePose(call.scene.view(), call.scene.camera, call.initial, call.options);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

void expectRefusal(const std::string& expected, const std::function<void(Call&)>& spoil) {
  const std::string message = refusalOf(spoil);
  EXPECT_EQ(message.rfind(expected, 0), 0U)
      << "expected: " << expected << "\n but got: " << message;
}

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(PoseRefinementInput, AGoodCallIsAccepted) {
  EXPECT_EQ(refusalOf([](Call&) {}), "accepted");
}

TEST(PoseRefinementInput, ArraysOfUnequalSizesAreRefused) {
  expectRefusal("size of observations.y is 9, expected 10, the size of x",
                [](Call& call) { call.scene.y.pop_back(); });
  expectRefusal("size of observations.z is 9", [](Call& call) { call.scene.z.pop_back(); });
  expectRefusal("size of observations.u is 0, expected 10",
                [](Call& call) { call.scene.u.clear(); });
  expectRefusal("size of observations.v is 9", [](Call& call) { call.scene.v.pop_back(); });
  expectRefusal("size of observations.sigma is 9, expected 10, the size of x, or 0",
                [](Call& call) { call.scene.sigma.pop_back(); });
  expectRefusal("size of observations.depth is 9", [](Call& call) { call.scene.depth.pop_back(); });
  expectRefusal("size of observations.weight is 11",
                [](Call& call) { call.scene.weight.push_back(1.0f); });
}

TEST(PoseRefinementInput, ADepthRowNeedsDepths) {
  for (const DepthRow row : {DepthRow::kDepth, DepthRow::kDisparity}) {
    expectRefusal("size of observations.depth is 0, expected 10", [row](Call& call) {
      call.options.depth_row = row;
      call.scene.depth.clear();
    });
  }
}

TEST(PoseRefinementInput, WeightsAndSigmasOutOfRangeAreRefused) {
  expectRefusal("observations.weight[3] is -0.5", [](Call& call) { call.scene.weight[3] = -0.5f; });
  expectRefusal("observations.weight[3] is nan", [](Call& call) { call.scene.weight[3] = kNaN; });
  expectRefusal("observations.weight[0] is inf",
                [](Call& call) { call.scene.weight[0] = std::numeric_limits<float>::infinity(); });
  expectRefusal("observations.sigma[9] is 0.000000, expected finite and > 0",
                [](Call& call) { call.scene.sigma[9] = 0.0f; });
  expectRefusal("observations.sigma[2] is -1", [](Call& call) { call.scene.sigma[2] = -1.0f; });
  expectRefusal("observations.sigma[2] is nan", [](Call& call) { call.scene.sigma[2] = kNaN; });
}

TEST(PoseRefinementInput, ACameraWithoutFocalLengthIsRefused) {
  expectRefusal("camera.fx is 0.000000, expected finite and > 0",
                [](Call& call) { call.scene.camera.fx = 0.0; });
  expectRefusal("camera.fy is -500", [](Call& call) { call.scene.camera.fy = -500.0; });
  expectRefusal("camera.fy is inf", [](Call& call) { call.scene.camera.fy = kInfinity; });
  expectRefusal("camera.cx is nan", [](Call& call) { call.scene.camera.cx = kNaN; });
  expectRefusal("camera.cy is inf", [](Call& call) { call.scene.camera.cy = kInfinity; });
}

TEST(PoseRefinementInput, AnInitialPoseThatIsNoMotionIsRefused) {
  expectRefusal("initial is not finite", [](Call& call) { call.initial.translation().x() = kNaN; });
  expectRefusal("initial is not finite",
                [](Call& call) { call.initial.linear()(1, 1) = kInfinity; });
  expectRefusal("initial is not a rigid motion",
                [](Call& call) { call.initial.linear().setZero(); });
  expectRefusal("initial is not a rigid motion", [](Call& call) { call.initial.linear() *= 1.01; });
  expectRefusal("initial is not a rigid motion",  // a reflection
                [](Call& call) { call.initial.linear().col(0) *= -1.0; });
}

TEST(PoseRefinementInput, OptionsOutOfRangeAreRefused) {
  using Options = PoseRefinementOptions;
  const auto expectOption = [](const std::string& expected,
                               const std::function<void(Options&)>& spoil) {
    expectRefusal("options." + expected, [&spoil](Call& call) { spoil(call.options); });
  };
  expectOption("rounds is 0, expected at least 1", [](Options& options) { options.rounds = 0; });
  expectOption("plain_rounds is -1", [](Options& options) { options.plain_rounds = -1; });
  expectOption("plain_rounds is 5, expected at most options.rounds, 4",
               [](Options& options) { options.plain_rounds = 5; });
  expectOption("max_iterations is 0", [](Options& options) { options.max_iterations = 0; });
  expectOption("huber_two_rows is 0", [](Options& options) { options.huber_two_rows = 0.0; });
  expectOption("huber_three_rows is nan",
               [](Options& options) { options.huber_three_rows = kNaN; });
  expectOption("chi2_two_rows is -1", [](Options& options) { options.chi2_two_rows = -1.0; });
  expectOption("chi2_three_rows is 0", [](Options& options) { options.chi2_three_rows = 0.0; });
  expectOption("min_depth is -1", [](Options& options) { options.min_depth = -1.0; });
  expectOption("function_tolerance is -1",
               [](Options& options) { options.function_tolerance = -1.0; });
  expectOption("gradient_tolerance is nan",
               [](Options& options) { options.gradient_tolerance = kNaN; });
  expectOption("parameter_tolerance is inf",
               [](Options& options) { options.parameter_tolerance = kInfinity; });
  expectOption("kappa is 0", [](Options& options) {
    options.weight_mode = WeightMode::kJoint;
    options.kappa = 0.0;
  });
  expectOption("baseline_fx is 0", [](Options& options) {
    options.depth_row = DepthRow::kDisparity;
    options.baseline_fx = 0.0;
  });
}

TEST(PoseRefinementInput, ADepthErrorOutOfRangeIsRefused) {
  expectRefusal("DepthErrorModel: noise_floor is -1", [](Call& call) {
    call.options.depth_row = DepthRow::kDepth;
    call.options.depth_error.noise_floor = -1.0f;
  });
}

TEST(PoseRefinementTermination, HasWordsForEachReason) {
  EXPECT_STREQ(toString(PoseRefinementTermination::kConverged), "converged");
  EXPECT_STREQ(toString(PoseRefinementTermination::kIterationLimit), "iteration limit");
  EXPECT_STREQ(toString(PoseRefinementTermination::kTooFewPoints), "too few points");
  EXPECT_STREQ(toString(PoseRefinementTermination::kTooFewInliers), "too few inliers");
  EXPECT_STREQ(toString(PoseRefinementTermination::kNumericalFailure), "numerical failure");
}

}  // namespace
}  // namespace hmcdyn

// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/relative_pose_error.hpp"

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "expect_throw.hpp"
#include "trajectories.hpp"

namespace hmcdyn::evaluate {
namespace {

constexpr double kPi = 3.14159265358979323846;

RpeOptions deltaOf(double delta, DeltaUnit unit) {
  RpeOptions options;
  options.delta = delta;
  options.delta_unit = unit;
  return options;
}

TEST(RelativePoseError, IsZeroAfterARigidTransform) {
  std::mt19937 random(1);
  const Trajectory truth = test::helix(50);
  const RpeResult result =
      relativePoseError(truth, test::moved(test::randomPose(random, 4.0), truth));
  EXPECT_NEAR(result.translation.max, 0.0, 1e-12);
  EXPECT_NEAR(result.rotation.max, 0.0, 1e-6);
}

TEST(RelativePoseError, OfAWrongSpeedIsTheLackPerSecond) {
  // 0.5 m/s instead of 0.6 m/s, 50 poses at 10 Hz: poses 0..38 have one a second later that is not
  // the last.
  const RpeResult result =
      relativePoseError(test::straightLine(50, 0.6), test::straightLine(50, 0.5));
  EXPECT_EQ(result.translation.count, 39U);
  EXPECT_NEAR(result.translation.rmse, 0.1, 1e-12);
  EXPECT_NEAR(result.translation.std, 0.0, 1e-12);
  EXPECT_NEAR(result.rotation.max, 0.0, 1e-12);
  EXPECT_DOUBLE_EQ(result.begin_timestamps.front(), 0.0);
  EXPECT_DOUBLE_EQ(result.end_timestamps.front(), 1.0);
}

TEST(RelativePoseError, OfAWrongTurnRateIsInDegrees) {
  // The camera turns on the spot, 3 degrees a second too fast.
  const double degree = kPi / 180.0;
  const RpeResult result = relativePoseError(test::straightLine(50, 0.0, 20.0 * degree),
                                             test::straightLine(50, 0.0, 23.0 * degree));
  EXPECT_NEAR(result.rotation.min, 3.0, 1e-9);
  EXPECT_NEAR(result.rotation.max, 3.0, 1e-9);
  EXPECT_NEAR(result.translation.max, 0.0, 1e-12);
}

TEST(RelativePoseError, OfAHalfTurnIsDefined) {
  const RpeResult result =
      relativePoseError(test::straightLine(50, 0.0), test::straightLine(50, 0.0, kPi));
  EXPECT_NEAR(result.rotation.rmse, 180.0, 1e-5);
}

TEST(RelativePoseError, DoesNotDependOnEitherWorldFrame) {
  std::mt19937 random(2);
  const Trajectory truth = test::helix(60);
  const Trajectory estimate = test::disturbed(truth, random);
  const RpeResult expected = relativePoseError(truth, estimate);
  for (int round = 0; round < 5; ++round) {
    const RpeResult result =
        relativePoseError(test::moved(test::randomPose(random, 9.0), truth),
                          test::moved(test::randomPose(random, 9.0), estimate));
    ASSERT_EQ(result.translation.count, expected.translation.count);
    for (std::size_t i = 0; i < result.translation_errors.size(); ++i) {
      EXPECT_NEAR(result.translation_errors[i], expected.translation_errors[i], 1e-10);
      EXPECT_NEAR(result.rotation_errors[i], expected.rotation_errors[i], 1e-8);
    }
  }
}

TEST(RelativePoseError, CountsFrames) {
  // 0.1 m/s too slow: 0.02 m over two frames. Poses 0..6 of 10 have a partner before the last.
  const RpeResult result = relativePoseError(
      test::straightLine(10, 0.6), test::straightLine(10, 0.5), deltaOf(2.0, DeltaUnit::kFrames));
  EXPECT_EQ(result.translation.count, 7U);
  EXPECT_NEAR(result.translation.rmse, 0.02, 1e-12);
}

TEST(RelativePoseError, MeasuresThePathOfTheEstimate) {
  // The estimate goes 0.05 m a pose, so that 0.2 m are 4 poses; the truth goes 0.24 m meanwhile.
  const RpeResult result = relativePoseError(
      test::straightLine(20, 0.6), test::straightLine(20, 0.5), deltaOf(0.2, DeltaUnit::kMetres));
  EXPECT_EQ(result.translation.count, 15U);
  EXPECT_NEAR(result.translation.rmse, 0.04, 1e-12);
}

TEST(RelativePoseError, SumsTheAnglesTurned) {
  // 0.1 rad a pose: 0.5 rad are 5 poses.
  const Trajectory truth = test::straightLine(20, 0.6, 1.0);
  const Trajectory estimate = test::straightLine(20, 0.5, 1.0);
  const RpeResult radians = relativePoseError(truth, estimate, deltaOf(0.5, DeltaUnit::kRadians));
  const RpeResult degrees =
      relativePoseError(truth, estimate, deltaOf(0.5 * 180.0 / kPi, DeltaUnit::kDegrees));
  EXPECT_EQ(radians.translation.count, 14U);
  EXPECT_NEAR(radians.translation.rmse, 0.05, 1e-12);
  EXPECT_EQ(degrees.begin_timestamps, radians.begin_timestamps);
  EXPECT_EQ(degrees.end_timestamps, radians.end_timestamps);
}

TEST(RelativePoseError, OfTwoEquallyClosePartnersTakesTheEarlier) {
  // At one pose a second 1.5 s lie between two poses: 1 s at 0.1 m/s too slow.
  Trajectory truth;
  Trajectory estimate;
  for (int i = 0; i < 8; ++i) {
    truth.push_back(test::stampedPose(i, {0.6 * i, 0.0, 0.0}));
    estimate.push_back(test::stampedPose(i, {0.5 * i, 0.0, 0.0}));
  }
  const RpeResult result = relativePoseError(truth, estimate, deltaOf(1.5, DeltaUnit::kSeconds));
  EXPECT_NEAR(result.translation.max, 0.1, 1e-12);
}

TEST(RelativePoseError, NeverPairsAPoseWithItself) {
  // Between 1 s and 4 s there is no pose; the pose nearest to 1 s + 1 s is the one at 1 s.
  Trajectory estimate;
  for (const double time : {0.0, 1.0, 4.0, 5.0, 6.0}) {
    estimate.push_back(test::stampedPose(time, {time, 0.0, 0.0}));
  }
  const RpeResult result = relativePoseError(test::straightLine(70, 1.1), estimate);
  EXPECT_THAT(result.begin_timestamps, testing::ElementsAre(0.0, 4.0));
  EXPECT_THAT(result.end_timestamps, testing::ElementsAre(1.0, 5.0));
}

TEST(RelativePoseError, LeavesOutPairsWithoutGroundTruth) {
  // No ground truth from 1.8 s to 2.2 s: five pairs begin there and five end there.
  Trajectory truth = test::straightLine(50, 0.6);
  truth.erase(truth.begin() + 18, truth.begin() + 23);
  RpeOptions options;
  options.tolerance = 0.01;
  const RpeResult result = relativePoseError(truth, test::straightLine(50, 0.6), options);
  EXPECT_EQ(result.translation.count, 39U - 10U);
  EXPECT_NEAR(result.translation.max, 0.0, 1e-12);
}

TEST(RelativePoseError, AppliesScaleAndOffset) {
  RpeOptions options;
  options.scale = 2.0;
  options.offset = -100.0;
  const RpeResult result = relativePoseError(
      test::helix(50), test::delayed(100.0, test::resized(0.5, test::helix(50))), options);
  EXPECT_NEAR(result.translation.max, 0.0, 1e-12);
}

TEST(RelativePoseError, SaysWhyThereAreTooFewPairs) {
  const Trajectory short_line = test::straightLine(12, 0.5);
  EXPECT_EQ(test::messageOf<std::runtime_error>([&] { relativePoseError(short_line, short_line); }),
            "1 pairs of poses lie 1 s apart with ground truth at both ends; at least 2 are needed "
            "(12 poses over 1.100 s, 1 pairs before the ground truth was looked up)");
  const Trajectory line = test::straightLine(30, 0.5);
  EXPECT_THROW(relativePoseError(line, test::delayed(100.0, line)), std::runtime_error);
}

TEST(RelativePoseError, OfASinglePoseIsRefused) {
  const Trajectory line = test::straightLine(30, 0.5);
  EXPECT_THROW(relativePoseError(line, test::straightLine(1, 0.5)), std::runtime_error);
  EXPECT_THROW(relativePoseError(test::straightLine(1, 0.5), line), std::runtime_error);
}

TEST(RelativePoseError, RefusesBadOptions) {
  const Trajectory line = test::straightLine(30, 0.5);
  const auto messageFor = [&](const RpeOptions& options) {
    return test::messageOf<std::invalid_argument>([&] { relativePoseError(line, line, options); });
  };
  EXPECT_EQ(messageFor(deltaOf(0.0, DeltaUnit::kSeconds)),
            "relativePoseError: delta is 0; expected more than 0");
  EXPECT_EQ(messageFor(deltaOf(1.5, DeltaUnit::kFrames)),
            "relativePoseError: delta is 1.5 frames; expected a whole number");
  RpeOptions options;
  options.scale = -1.0;
  EXPECT_EQ(messageFor(options), "relativePoseError: scale is -1; expected more than 0");
  options = {};
  options.tolerance = -1.0;
  EXPECT_EQ(messageFor(options), "relativePoseError: tolerance is -1 s; expected at least 0");
  options = {};
  options.offset = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(messageFor(options), "relativePoseError: offset is nan s; expected a finite time");
}

}  // namespace
}  // namespace hmcdyn::evaluate

// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/absolute_trajectory_error.hpp"

#include <cmath>
#include <random>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "expect_throw.hpp"
#include "trajectories.hpp"

namespace hmcdyn::evaluate {
namespace {

/// The corners of a square of side 2 m, one a second, in the plane z = 0.
Trajectory square() {
  return {test::stampedPose(0.0, {1.0, 1.0, 0.0}), test::stampedPose(1.0, {-1.0, 1.0, 0.0}),
          test::stampedPose(2.0, {-1.0, -1.0, 0.0}), test::stampedPose(3.0, {1.0, -1.0, 0.0})};
}

TEST(AbsoluteTrajectoryError, IsZeroAfterARigidTransform) {
  std::mt19937 random(1);
  const Trajectory truth = test::helix(50);
  const AteResult result =
      absoluteTrajectoryError(truth, test::moved(test::randomPose(random, 4.0), truth));
  EXPECT_NEAR(result.error.max, 0.0, 1e-12);
  EXPECT_EQ(result.error.count, 50U);
}

TEST(AbsoluteTrajectoryError, OfASaddleIsItsHeight) {
  // Corners lifted in turn by +-0.1 m: neither a shift nor a turn makes that better.
  Trajectory estimate = square();
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    estimate[i].pose.translation().z() = i % 2 == 0 ? 0.1 : -0.1;
  }
  const AteResult result = absoluteTrajectoryError(square(), estimate);
  EXPECT_NEAR(result.error.rmse, 0.1, 1e-12);
  EXPECT_NEAR(result.error.min, 0.1, 1e-12);
  EXPECT_NEAR(result.error.max, 0.1, 1e-12);
  EXPECT_NEAR(result.error.std, 0.0, 1e-12);
}

TEST(AbsoluteTrajectoryError, OfAWrongScaleStaysUnlessTheScaleIsFitted) {
  const Trajectory estimate = test::resized(0.5, square());
  const AteResult rigid = absoluteTrajectoryError(square(), estimate);
  EXPECT_NEAR(rigid.error.mean, 0.5 * std::sqrt(2.0), 1e-12);

  AteOptions options;
  options.alignment = AlignmentModel::kSimilarity;
  const AteResult similar = absoluteTrajectoryError(square(), estimate, options);
  EXPECT_NEAR(similar.error.max, 0.0, 1e-12);
  EXPECT_NEAR(similar.alignment.scale, 2.0, 1e-12);
}

TEST(AbsoluteTrajectoryError, DoesNotDependOnEitherWorldFrame) {
  std::mt19937 random(2);
  const Trajectory truth = test::helix(80);
  const Trajectory estimate = test::disturbed(truth, random);
  const AteResult expected = absoluteTrajectoryError(truth, estimate);
  for (int round = 0; round < 5; ++round) {
    const AteResult result =
        absoluteTrajectoryError(test::moved(test::randomPose(random, 9.0), truth),
                                test::moved(test::randomPose(random, 9.0), estimate));
    ASSERT_EQ(result.errors.size(), expected.errors.size());
    for (std::size_t i = 0; i < result.errors.size(); ++i) {
      EXPECT_NEAR(result.errors[i], expected.errors[i], 1e-10);
    }
  }
}

TEST(AbsoluteTrajectoryError, ListsTheAssociatedFramesAligned) {
  // The third corner has no ground truth within the tolerance.
  Trajectory estimate =
      test::moved(Eigen::Isometry3d(Eigen::Translation3d(5.0, 0.0, 0.0)), square());
  estimate[0].timestamp = 0.015;
  estimate[2].timestamp = 2.5;
  const AteResult result = absoluteTrajectoryError(square(), estimate);
  EXPECT_THAT(result.timestamps, testing::ElementsAre(0.015, 1.0, 3.0));
  EXPECT_EQ(result.errors.size(), 3U);
  ASSERT_EQ(result.estimated.size(), 3U);
  EXPECT_TRUE(result.estimated[2].isApprox(Eigen::Vector3d(1.0, -1.0, 0.0), 1e-12));
  EXPECT_TRUE(result.groundtruth[2].isApprox(Eigen::Vector3d(1.0, -1.0, 0.0), 1e-12));
}

TEST(AbsoluteTrajectoryError, AddsTheOffsetToTheEstimate) {
  AteOptions options;
  options.association.offset = -100.0;
  const AteResult result =
      absoluteTrajectoryError(square(), test::delayed(100.0, square()), options);
  EXPECT_EQ(result.error.count, 4U);
  EXPECT_DOUBLE_EQ(result.timestamps.front(), 100.0);
}

TEST(AbsoluteTrajectoryError, SaysWhyTooFewPosesAreAssociated) {
  EXPECT_EQ(
      test::messageOf<std::runtime_error>(
          [] { absoluteTrajectoryError(square(), test::delayed(100.0, square())); }),
      "0 of 4 poses lie within 0.02 s of a ground-truth pose; at least 3 are needed "
      "(estimate 100.000 to 103.000 s, ground truth 0.000 to 3.000 s, offset 0 s; if both began "
      "together, the offset is -100.000 s)");
}

TEST(AbsoluteTrajectoryError, RefusesEmptyAndUnsortedTrajectories) {
  EXPECT_EQ(test::messageOf<std::invalid_argument>([] { absoluteTrajectoryError(square(), {}); }),
            "estimate: has 0 poses; expected at least 1");
  Trajectory doubled = square();
  doubled[1].timestamp = 0.0;
  EXPECT_EQ(
      test::messageOf<std::invalid_argument>([&] { absoluteTrajectoryError(doubled, square()); }),
      "groundtruth: timestamp 0.000000 of pose 1 follows 0.000000; expected time to increase");
}

}  // namespace
}  // namespace hmcdyn::evaluate

// SPDX-License-Identifier: BSD-3-Clause
#include "mask/mask_score.hpp"

#include <cmath>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "mask/mask_run.hpp"

namespace hmcdyn::masking {
namespace {

cv::Mat square(int x, int side, int value = 255) {
  cv::Mat mask = cv::Mat::zeros(100, 100, CV_8UC1);
  mask(cv::Rect(x, 20, side, side)) = value;
  return mask;
}

TEST(MaskScore, CountsPixels) {
  // Given a true square of 40 x 40 and one that is found 10 px beside it
  MaskScore score;
  scoreFrame(square(20, 40), square(30, 40), {}, score);
  // Then 30 x 40 are right, 10 x 40 wrong and 10 x 40 missed
  EXPECT_DOUBLE_EQ(score.iou(), 1200.0 / 2000.0);
  EXPECT_DOUBLE_EQ(score.precision(), 0.75);
  EXPECT_DOUBLE_EQ(score.recall(), 0.75);
  EXPECT_DOUBLE_EQ(score.falseShare(), 400.0 / 10000.0);
}

TEST(MaskScore, LeavesOutWhoStands) {
  MaskScore score;
  scoreFrame(square(20, 40, 128), square(20, 40), {}, score);
  EXPECT_EQ(score.false_moving, 0);
  EXPECT_TRUE(std::isnan(score.recall()));
  EXPECT_EQ(score.standing_as_moving, 1600);
}

TEST(MaskScore, BordersAgreeWithinTheDistance) {
  MaskScore near;
  scoreFrame(square(20, 40), square(23, 40), {}, near);
  EXPECT_DOUBLE_EQ(near.boundaryF(), 1.0);
  // Given the left and right side 4 px off: of 156 border pixels, those of them that the upper and
  // the lower side are not within 3 px of are wrong
  MaskScore far;
  scoreFrame(square(20, 40), square(24, 40), {}, far);
  EXPECT_LT(far.boundaryF(), 0.6);
  EXPECT_GT(far.boundaryF(), 0.4);
}

TEST(MaskScore, TimesHowSoonAThingIsFoundAndReleased) {
  // Given a square that stands, moves from frame 2 (0.2 s) to 5, and stands again
  MaskScoreOptions options;
  ThingClock clock(options);
  MaskScore score;
  for (int k = 0; k < 10; ++k) {
    const bool moves = k >= 2 && k < 6;
    const bool called = k >= 4 && k < 9;
    clock.update(0.1 * k, square(20, 40, moves ? 255 : 128),
                 called ? square(20, 40) : square(0, 1, 0), true, score);
  }
  // Then it is found after 0.2 s and released after 0.3 s
  ASSERT_EQ(score.seconds_to_find.size(), 1U);
  EXPECT_NEAR(score.seconds_to_find[0], 0.2, 1e-9);
  ASSERT_EQ(score.seconds_to_release.size(), 1U);
  EXPECT_NEAR(score.seconds_to_release[0], 0.3, 1e-9);
  EXPECT_EQ(score.never_found, 0U);
  EXPECT_EQ(score.things, 4U);
  EXPECT_EQ(score.things_found, 2U);
}

TEST(MaskScore, ReadsFoldersByStampsToTheMillisecond) {
  const auto folder = std::filesystem::path(testing::TempDir()) / "hmcdyn_mask_score_test";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder / "truth" / "mask");
  std::filesystem::create_directories(folder / "found");
  cv::imwrite((folder / "truth/mask/1.000000.png").string(), square(20, 40));
  cv::imwrite((folder / "truth/mask/1.100000.png").string(), square(20, 40));
  cv::imwrite((folder / "found/1.0001.png").string(), square(20, 40));
  MaskScoreOptions options;
  options.skip_frames = 0;
  const MaskScore score = scoreMasks(folder / "truth", folder / "found", options);
  // Then the frame without a mask counts as one in which nothing was found
  EXPECT_EQ(score.frames, 2U);
  EXPECT_EQ(score.without_mask, 1U);
  EXPECT_DOUBLE_EQ(score.recall(), 0.5);
  EXPECT_DOUBLE_EQ(score.precision(), 1.0);
  EXPECT_THROW(scoreMasks(folder / "truth", folder / "nothing", options), std::runtime_error);
  std::filesystem::remove_all(folder);
}

TEST(PoseAt, IsTheStampsOrBetweenItsNeighbours) {
  evaluate::Trajectory trajectory(2);
  trajectory[0].timestamp = 1.0;
  trajectory[1].timestamp = 1.1;
  trajectory[1].pose.translation().x() = 1.0;
  EXPECT_NEAR(poseAt(trajectory, 1.1, 0.2)->translation().x(), 1.0, 1e-12);
  EXPECT_NEAR(poseAt(trajectory, 1.075, 0.2)->translation().x(), 0.75, 1e-9);
  EXPECT_FALSE(poseAt(trajectory, 1.075, 0.05).has_value());
  EXPECT_FALSE(poseAt(trajectory, 1.2, 0.2).has_value());
  EXPECT_FALSE(poseAt(trajectory, 0.9, 0.2).has_value());
}

}  // namespace
}  // namespace hmcdyn::masking

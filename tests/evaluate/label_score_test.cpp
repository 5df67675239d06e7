// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/label_score.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace hmcdyn::evaluate {
namespace {

/// A sequence of one frame: a moving square at columns 20-39, a standing one at 60-79, rows 10-29.
class LabelScoring : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        std::filesystem::temp_directory_path() / ("hmcdyn_label_score_" + std::to_string(getpid()));
    std::filesystem::create_directories(folder_ / "mask");
    cv::Mat mask = cv::Mat::zeros(48, 100, CV_8U);
    cv::rectangle(mask, cv::Rect(20, 10, 20, 20), cv::Scalar(255), cv::FILLED);
    cv::rectangle(mask, cv::Rect(60, 10, 20, 20), cv::Scalar(128), cv::FILLED);
    cv::imwrite((folder_ / "mask" / "1.000000.png").string(), mask);
    std::ofstream(folder_ / "boxes.txt") << "# boxes\n1.000000 0 10 5 50 35 1.0\n";
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write(const std::string& rows) const {
    std::ofstream(folder_ / "keypoints.csv")
        << "timestamp,u,v,depth,distance,cluster,label,weight\n"
        << rows;
    return folder_ / "keypoints.csv";
  }

  std::filesystem::path folder_;
};

TEST_F(LabelScoring, CountsEveryKindOfPointOnce) {
  const auto file = write(
      "1.000000,30,20,2,3,0,dynamic,0\n"       // moving, found
      "1.000000,25,15,2,nan,-1,unmatched,0\n"  // moving, missed
      "1.000000,30,25,2,0.2,0,suspect,0.4\n"   // moving, missed
      "1.000000,14,20,3,0.1,1,suspect,1\n"     // static in the box, kept
      "1.000000,45,20,3,2,1,dynamic,0\n"       // static in the box, thrown away
      "1.000000,95,40,3,0.1,-1,static,1\n"     // static outside
      "1.000000,19,20,3,0.1,-1,static,1\n"     // one pixel from the silhouette
      "1.000000,70,20,2,0,-1,static,1\n");     // on the standing person
  const LabelScore score = scoreLabels(readLabelledPoints(file), folder_);
  EXPECT_EQ(score.true_dynamic, 1U);
  EXPECT_EQ(score.missed_dynamic, 2U);
  EXPECT_EQ(score.false_dynamic, 1U);
  EXPECT_EQ(score.true_static, 2U);
  EXPECT_EQ(score.static_in_boxes, 2U);
  EXPECT_EQ(score.kept_in_boxes, 1U);
  EXPECT_EQ(score.on_border, 1U);
  EXPECT_EQ(score.standing, 1U);
  EXPECT_DOUBLE_EQ(score.precision(), 1.0 / 2.0);
  EXPECT_DOUBLE_EQ(score.recall(), 1.0 / 3.0);
  EXPECT_DOUBLE_EQ(score.f1(), 2.0 / 5.0);  // 2 * 1/2 * 1/3 / (1/2 + 1/3)
  EXPECT_DOUBLE_EQ(score.keptShare(), 1.0 / 2.0);
}

TEST_F(LabelScoring, TheMarginIsTheDetectorsRingAtThePointsLevelOrFixed) {
  std::ofstream(folder_ / "sized.csv")
      << "timestamp,u,v,depth,distance,cluster,label,weight,size\n"
         "1.000000,16,20,3,0,-1,static,1,31\n"   // 4 px from the silhouette, ring of 3 px
         "1.000000,16,20,3,0,-1,static,1,62\n"   // the same point two octaves up: ring of 6 px
         "1.000000,17,20,3,0,-1,static,1,31\n";  // 3 px
  const std::vector<LabelledPoint> points = readLabelledPoints(folder_ / "sized.csv");
  EXPECT_DOUBLE_EQ(points[1].scale, 2.0);
  const LabelScore by_ring = scoreLabels(points, folder_);
  EXPECT_EQ(by_ring.true_static, 1U);
  EXPECT_EQ(by_ring.on_border, 2U);
  LabelScoreOptions fixed;
  fixed.margin = 2;
  EXPECT_EQ(scoreLabels(points, folder_, fixed).true_static, 3U);
}

TEST_F(LabelScoring, SharesAreUndefinedWithoutPoints) {
  const LabelScore score;
  EXPECT_TRUE(std::isnan(score.precision()));
  EXPECT_TRUE(std::isnan(score.recall()));
  EXPECT_TRUE(std::isnan(score.keptShare()));
}

TEST_F(LabelScoring, SkippedFramesDoNotCount) {
  const auto file = write("1.000000,30,20,2,3,0,dynamic,0\n");
  LabelScoreOptions options;
  options.skip_frames = 1;
  EXPECT_EQ(scoreLabels(readLabelledPoints(file), folder_, options).true_dynamic, 0U);
}

TEST_F(LabelScoring, MalformedRowIsNamedWithFileAndLine) {
  const auto file = write("1.000000,30,20,2,3,0,dynamic,0\n1.000000,x,20,2,3,0,dynamic,0\n");
  try {
    readLabelledPoints(file);
    FAIL() << "expected std::runtime_error";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(
        std::string(error.what()).find("keypoints.csv:3: expected a finite number, found 'x'"),
        std::string::npos)
        << error.what();
  }
}

TEST_F(LabelScoring, SequenceWithoutMasksIsAnError) {
  const auto file = write("2.000000,30,20,2,3,0,dynamic,0\n");
  EXPECT_THROW(scoreLabels(readLabelledPoints(file), folder_), std::runtime_error);
  EXPECT_THROW(scoreLabels(readLabelledPoints(file), folder_ / "nowhere"), std::runtime_error);
}

}  // namespace
}  // namespace hmcdyn::evaluate

// SPDX-License-Identifier: BSD-3-Clause
// Kind 8: with too little to go on, one line says what was missing, and an exit code of its own.
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "fault_input.hpp"
#include "slam/input/source/folder_source.hpp"
#include "slam/run/run.hpp"
#include "slam/run/summary.hpp"

namespace hmcdyn::faults {
namespace {

using hmcdyn::test::mentions;

class Little : public ToyFolder {
 protected:
  static std::vector<std::string> warningsOf(const nlohmann::json& summary) {
    return summary.at("warnings").get<std::vector<std::string>>();
  }
};

TEST_F(Little, WithoutAnyDepthTheReasonIsSaid) {
  slam::test::ToySequence toy_without;
  toy_without.with_depth = false;
  slam::test::writeToySequence(toy(), toy_without);
  const nlohmann::json summary = slam::runSlam(options());
  EXPECT_EQ(summary.at("counts").at("frames_tracked"), 0);
  EXPECT_EQ(slam::exitCodeOf(summary), slam::kFewPoses);
  EXPECT_TRUE(
      oneMentions(warningsOf(summary), {"0 of 8 frames have a pose", "8 frames have no depth"}));
}

TEST_F(Little, FramesOfOneFaultAreNamedOnceAndCounted) {
  for (int k = 0; k < 8; ++k) {
    const std::string name = "depth/" + slam::test::toyStamp(k) + ".png";
    cv::imwrite((toy() / name).string(), cv::Mat(240, 320, CV_8UC1, cv::Scalar(9)));
  }
  std::vector<std::string> reports;
  slam::TumFolderSource source(toy(), slam::DatasetOptions{},
                               slam::loadCamera((toy() / "calibration.yaml").string()),
                               [&](const std::string& line) { reports.push_back(line); });
  EXPECT_FALSE(source.next().has_value());
  ASSERT_EQ(reports.size(), 2U);
  EXPECT_TRUE(mentions(reports[0], {"frame 0 is left out", "1000.000000.png", "16 bits"}));
  EXPECT_TRUE(mentions(reports[1], {"8 frames were left out in all", "16 bits"}));
}

TEST(FewPoses, HalfOfTheFramesAreEnoughAndFewerHaveTheirOwnCode) {
  nlohmann::json summary = {
      {"counts",
       {{"frames_in", 10}, {"frames_tracked", 5}, {"write_failures", nlohmann::json::array()}}},
      {"errors", nlohmann::json::array()}};
  EXPECT_EQ(slam::exitCodeOf(summary), 0);
  summary["counts"]["frames_tracked"] = 4;
  EXPECT_EQ(slam::exitCodeOf(summary), 3);
  summary["counts"]["frames_tracked"] = 0;
  EXPECT_EQ(slam::exitCodeOf(summary), 3);
  summary["errors"].push_back({{"part", "tracking"}});
  EXPECT_EQ(slam::exitCodeOf(summary), 1);
}

TEST(FewPoses, TheReasonIsWhatMostFramesLacked) {
  slam::RunCounts counts;
  counts.source.taken_up = 12;
  counts.frames_tracked = 6;
  EXPECT_EQ(slam::whyFewPoses(counts), "");
  counts.frames_tracked = 1;
  counts.source.unreadable = 8;
  counts.failures["too few matches"] = 3;
  const std::string reason = slam::whyFewPoses(counts);
  EXPECT_TRUE(mentions(reason, {"1 of 12 frames have a pose", "8 frames could not be read"}));
  EXPECT_EQ(reason.find("matches"), std::string::npos);  // 3 explain nothing
}

}  // namespace
}  // namespace hmcdyn::faults

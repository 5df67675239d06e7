// SPDX-License-Identifier: BSD-3-Clause
// Kind 10, and the same care in every program, as a user meets them: processes with exit codes.
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "fault_input.hpp"
#include "run/shell.hpp"

namespace hmcdyn::faults {
namespace {

using hmcdyn::test::mentions;
using slam::test::Outcome;
using slam::test::runShell;

TEST(Options, NumbersThatCannotBeAreRefusedByName) {
  struct Case {
    const char* program;
    const char* arguments;
    const char* said;
  };
  for (const Case& entry : std::vector<Case>{
           {HMCDYN_SLAM, "--output o --dataset d --max-depth nan", "--max-depth"},
           {HMCDYN_SLAM, "--output o --dataset d --max-depth 0",
            "--max-depth: is 0; expected a number above 0"},
           {HMCDYN_SLAM, "--output o --dataset d --bridge=-1",
            "--bridge: is -1; expected 0 or more"},
           {HMCDYN_SLAM, "--output o --dataset d --baselines 0,nan", "--baselines"},
           {HMCDYN_SLAM, "--output o --dataset d --score-threshold 25",
            "--score-threshold: is 25; expected 0..1"},
           {HMCDYN_SLAM, "--output o --dataset d --nms-threshold=-0.1",
            "--nms-threshold: is -0.1; expected 0..1"},
           {HMCDYN_SLAM, "--output o --dataset d --input-size 500",
            "--input-size: is 500; expected 0, or a multiple of 32"},
           {HMCDYN_SLAM, "--output o --dataset d --command-timeout 0",
            "--command-timeout: is 0; expected more than 0"},
           {HMCDYN_SLAM, "--output o --dataset d --command-start-timeout=-1",
            "--command-start-timeout: is -1; expected more than 0"},
           {HMCDYN_SLAM, "--output o --dataset d --time-unit hours", "--time-unit"},
           {HMCDYN_EVALUATE, "ate -g a -e b --offset nan", "--offset"},
           {HMCDYN_SYNTHESIZE, "--output o --moving-speed nan", "--moving-speed"},
       }) {
    const Outcome outcome = runShell(std::string(entry.program) + " " + entry.arguments);
    EXPECT_EQ(outcome.exit_code, 2) << entry.arguments << "\n" << outcome.text;
    EXPECT_TRUE(mentions(outcome.text, {entry.said}));
  }
}

class Programs : public testing::Test {
 protected:
  static std::string poses(const std::string& unit_zeros) {
    std::string text;
    for (int i = 0; i < 20; ++i) {
      text += std::to_string(1341846400 + i) + unit_zeros + " " + std::to_string(i % 5) + " " +
              std::to_string(i % 3) + " 0 0 0 0 1\n";
    }
    return text;
  }
  Outcome evaluate(const std::string& truth, const std::string& estimate) const {
    return runShell(std::string(HMCDYN_EVALUATE) + " ate -g " +
                    folder_.write("truth.txt", truth).string() + " -e " +
                    folder_.write("estimate.txt", estimate).string());
  }

  hmcdyn::test::TemporaryFolder folder_;
};

TEST_F(Programs, TheEvaluationFindsOutTheUnitsOfBothFiles) {
  const Outcome outcome = evaluate(poses("000000000"), poses("000"));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_TRUE(mentions(outcome.text, {"nanoseconds", "estimate.txt", "fits the ground truth"}));
}

TEST_F(Programs, TheEvaluationSaysWhatItLeftOutAndHowFewItIsOf) {
  const Outcome outcome = evaluate(poses(""), poses("") +
                                                  "1341846500 1 1 0 0 0 0 1\n"
                                                  "1341846501 nan nan nan 0 0 0 0\n");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_TRUE(mentions(outcome.text, {"1 of 22 lines are left out"}));
}

TEST_F(Programs, TheEvaluationSaysWhatHelpsWhereTheClocksDiffer) {
  std::string shifted;
  for (const std::string& line : linesOf(poses(""))) {
    shifted += std::to_string(std::stol(line) - 1341846000) + line.substr(line.find(' ')) + "\n";
  }
  const Outcome outcome = evaluate(poses(""), shifted);
  EXPECT_EQ(outcome.exit_code, 1) << outcome.text;
  EXPECT_TRUE(mentions(outcome.text, {"0 of 20 poses", "the offset is 1341846000.000"}));
}

TEST_F(Programs, ASceneThatThereIsNotIsWrongUsage) {
  const Outcome outcome = runShell(std::string(HMCDYN_SYNTHESIZE) + " -s walkingxyz -o " +
                                   (folder_.path() / "o").string());
  EXPECT_EQ(outcome.exit_code, 2) << outcome.text;
  EXPECT_TRUE(mentions(outcome.text, {"walkingxyz", "walking_xyz"}));
}

TEST_F(Programs, MasksOfAnotherRecordingOrSizeAreNotScored) {
  const std::filesystem::path truth = folder_.path() / "scene" / "mask";
  std::filesystem::create_directories(truth);
  cv::imwrite((truth / "1.000000.png").string(), cv::Mat(8, 8, CV_8UC1, cv::Scalar(255)));
  const auto score = [&](const char* name, int side) {
    const std::filesystem::path masks = folder_.path() / name;
    std::filesystem::create_directories(masks);
    cv::imwrite((masks / name).string() + ".png", cv::Mat(side, side, CV_8UC1, cv::Scalar(255)));
    return runShell(std::string(HMCDYN_MASK_SCORE) + " --skip-frames 0 " +
                    (folder_.path() / "scene").string() + ":" + masks.string());
  };
  EXPECT_EQ(score("1.0", 8).exit_code, 0);
  const Outcome other = score("2.0", 8);
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_TRUE(mentions(other.text, {"none of its 1 images", "another recording"}));
  const Outcome small = score("1.00", 4);
  EXPECT_EQ(small.exit_code, 1);
  EXPECT_TRUE(mentions(small.text, {"1.00.png: is 4 x 4 pixels; expected 8 x 8"}));
}

TEST_F(Programs, LabelsWithoutAKeyPointAreNotScored) {
  const Outcome outcome = runShell(
      std::string(HMCDYN_LABEL_SCORE) + " " + folder_.path().string() + ":" +
      folder_.write("k.csv", "timestamp,u,v,depth,distance,cluster,label,weight\n").string());
  EXPECT_EQ(outcome.exit_code, 1) << outcome.text;
  EXPECT_TRUE(mentions(outcome.text, {"k.csv", "no key point"}));
}

TEST_F(Programs, ATableOfRunsNamesASummaryThatIsNone) {
  const Outcome outcome =
      runShell(std::string(HMCDYN_TABLES) + " --check " +
               folder_.write("summary.json", "\xEF\xBB\xBF{\"counts\":").string());
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_TRUE(mentions(outcome.text, {"summary.json"}));
}

TEST_F(Programs, LabelsAreScoredFromFilesWithOtherLineEnds) {
  const std::string csv =
      "\xEF\xBB\xBFtimestamp,u,v,depth,distance,cluster,label,weight\r\n"
      "1.000000,5,5,1,0,0,static,1\r\n";
  folder_.write("scene/boxes.txt", "\xEF\xBB\xBF# boxes\r\n1.000000\tperson\t1\t1\t9\t9\t1\r\n");
  const Outcome outcome =
      runShell(std::string(HMCDYN_LABEL_SCORE) + " " + (folder_.path() / "scene").string() + ":" +
               folder_.write("keypoints.csv", csv).string());
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_TRUE(mentions(outcome.text, {"mask", "no mask for any time stamp"}));  // all else was read
}

}  // namespace
}  // namespace hmcdyn::faults

// SPDX-License-Identifier: BSD-3-Clause
// hmcdyn_slam as a user meets it: a process with exit codes and messages.
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "input/dataset/temporary_folder.hpp"
#include "run/shell.hpp"
#include "run/toy_sequence.hpp"

namespace hmcdyn::slam {
namespace {

using test::Outcome;

Outcome runBinary(const std::string& arguments) {
  return test::runShell(std::string(HMCDYN_SLAM) + " " + arguments);
}

class Binary : public testing::Test {
 protected:
  /// Arguments of a run over a toy sequence; empty camera and output = the ordinary ones.
  std::string toyArguments(const std::string& camera = {}, const std::string& output = {}) {
    const std::string folder = folder_.path().string();
    test::writeToySequence(folder + "/toy");
    return fmt::format("--dataset {}/toy --camera {} --output {} --quiet", folder,
                       camera.empty() ? folder + "/toy/calibration.yaml" : camera,
                       output.empty() ? folder + "/out" : output);
  }

  hmcdyn::test::TemporaryFolder folder_;
};

TEST_F(Binary, HelpTeachesEveryGroupOfOptions) {
  const Outcome outcome = runBinary("--help");
  EXPECT_EQ(outcome.exit_code, 0);
  for (const char* text : {"Input", "Detection", "Filter", "Tracking", "Output",
                           "Example:", "--camera", "two_threshold (SG-SLAM)", "(1/m)"}) {
    EXPECT_NE(outcome.text.find(text), std::string::npos) << text;
  }
}

TEST_F(Binary, AGoodRunSaysWhatItTrackedAndWhereTheResultsAre) {
  const Outcome outcome = runBinary(toyArguments());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
  EXPECT_NE(outcome.text.find("tracked 8 of 8 frames, ATE RMSE"), std::string::npos)
      << outcome.text;
  EXPECT_NE(outcome.text.find("results in"), std::string::npos);
}

TEST_F(Binary, UsageErrorsExitWithTwo) {
  EXPECT_EQ(runBinary("").exit_code, 2);
  EXPECT_EQ(runBinary(toyArguments() + " --filter unknown").exit_code, 2);
  EXPECT_EQ(runBinary(toyArguments() + " --classes unicorn").exit_code, 2);
  const Outcome camera = runBinary(toyArguments("tum4"));
  EXPECT_EQ(camera.exit_code, 2);
  EXPECT_NE(camera.text.find("tum3"), std::string::npos) << camera.text;
}

TEST_F(Binary, DarknetWithoutWeightsNamesTheOption) {
  const Outcome outcome = runBinary(toyArguments() + " --detector darknet --model a.cfg");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.text.find("--weights"), std::string::npos) << outcome.text;
}

TEST_F(Binary, TheFormerDetectorMotionNamesWhatTookItsPlace) {
  const Outcome outcome = runBinary(toyArguments() + " --detector motion");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_TRUE(hmcdyn::test::mentions(outcome.text, {"--detector none --filter robust"}));
}

TEST_F(Binary, MasksOfAFilterThatMakesNoneAreAMistakeOfUsage) {
  const Outcome outcome = runBinary(toyArguments() + " --filter none --write-masks");
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_TRUE(hmcdyn::test::mentions(outcome.text, {"--write-masks", "--filter none", "robust"}));
  EXPECT_EQ(runBinary(toyArguments() + " --filter hmc --write-static-depth").exit_code, 2);
}

TEST_F(Binary, MasksAndStaticDepthAreWrittenOnRequest) {
  const Outcome outcome = runBinary(toyArguments() + " --write-masks --write-static-depth");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
  const std::string name = test::toyStamp(7) + ".png";
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "out" / "masks" / name));
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "out" / "static_depth" / name));
}

TEST_F(Binary, BadDataExitsWithOneAndNamesTheFile) {
  const std::string arguments = toyArguments();
  std::ofstream(folder_.path() / "toy" / "rgb.txt") << "# colour\n1000.0 rgb/a.png\nnonsense\n";
  const Outcome outcome = runBinary(arguments);
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.text.find("rgb.txt:3"), std::string::npos) << outcome.text;
}

TEST_F(Binary, AnOutputFolderThatCannotBeMadeIsNamed) {
  const Outcome outcome = runBinary(toyArguments({}, "/proc/hmcdyn_out"));
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_NE(outcome.text.find("/proc/hmcdyn_out"), std::string::npos) << outcome.text;
}

}  // namespace
}  // namespace hmcdyn::slam

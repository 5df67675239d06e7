// SPDX-License-Identifier: BSD-3-Clause
// The binary itself, run as a user runs it.
#include <cmath>
#include <cstdlib>
#include <random>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sys/wait.h>

#include "evaluate/trajectory.hpp"
#include "evaluate/truth_frame.hpp"
#include "temporary_folder.hpp"
#include "trajectories.hpp"

namespace hmcdyn::evaluate {
namespace {

using nlohmann::json;
using testing::HasSubstr;

struct ProcessResult {
  int exit_code = -1;
  std::string output;
  std::string errors;
};

class CommandLine : public test::TemporaryFolder {
 protected:
  /// Runs hmcdyn_evaluate in the shell.
  ProcessResult run(const std::string& arguments) const {
    const std::string command = "cd '" + path("").string() + "' && " HMCDYN_EVALUATE " " +
                                arguments + " > stdout.txt 2> stderr.txt";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read(path("stdout.txt")),
            read(path("stderr.txt"))};
  }

  json runJson(const std::string& arguments) const {
    const ProcessResult result = run(arguments + " --json");
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    return json::parse(result.output);
  }

  void write(const std::string& name, const Trajectory& trajectory) const {
    writeTrajectory(path(name), trajectory);
  }

  /// A square of side 2 m, a corner a second, and estimates that lie `height` beside each corner.
  static Trajectory square(double height) {
    return {
        test::stampedPose(0.0, {1.0, 1.0, height}), test::stampedPose(1.0, {-1.0, 1.0, -height}),
        test::stampedPose(2.0, {-1.0, -1.0, height}), test::stampedPose(3.0, {1.0, -1.0, -height})};
  }

  void SetUp() override {
    write("truth.txt", square(0.0));
    write("good.txt", square(0.1));
    write("better.txt", square(0.05));
    write("bad.txt", square(0.4));
  }
};

TEST_F(CommandLine, AteGivesJson) {
  const json result = runJson("ate --groundtruth truth.txt --estimate good.txt");
  for (const char* name : {"rmse", "mean", "median", "min", "max"}) {
    EXPECT_NEAR(result.at(name), 0.1, 1e-9) << name;
  }
  EXPECT_NEAR(result.at("std"), 0.0, 1e-9);
  EXPECT_EQ(result.at("pairs"), 4);
}

TEST_F(CommandLine, AGroundTruthOfBonnsMarkersIsMadeTheCameras) {
  // Given a camera that rolls where it stands, and its markers
  Trajectory camera;
  for (int i = 0; i < 40; ++i) {
    camera.push_back(
        {0.1 * i, Eigen::Isometry3d(Eigen::Translation3d(0.01 * i, 0.0, 0.0) *
                                    Eigen::AngleAxisd(0.1 * i, Eigen::Vector3d::UnitZ()))});
  }
  write("camera.txt", camera);
  for (StampedPose& stamped : camera) {
    stamped.pose = stamped.pose * bonnMarkersFromCamera().inverse();
  }
  write("markers.txt", camera);
  // When, then
  EXPECT_GT(runJson("ate -g markers.txt -e camera.txt").at("rmse"), 0.005);
  EXPECT_LT(runJson("ate -g markers.txt -e camera.txt --groundtruth-of bonn-markers").at("rmse"),
            1e-6);
  EXPECT_EQ(run("ate -g markers.txt -e camera.txt --groundtruth-of tripod").exit_code, 2);
}

TEST_F(CommandLine, RpeGivesJsonOfTranslationAndRotation) {
  // 0.1 m/s too slow, which is 0.2 m in 2 s.
  write("line.txt", test::straightLine(50, 0.6));
  write("slow.txt", test::straightLine(50, 0.5));
  const json result = runJson("rpe -g line.txt -e slow.txt --delta 2 --delta-unit s");
  EXPECT_NEAR(result.at("translation").at("rmse"), 0.2, 1e-6);
  EXPECT_EQ(result.at("translation").at("pairs"), 29);
  for (const char* name : {"rmse", "mean", "median", "std", "min", "max"}) {
    EXPECT_NEAR(result.at("rotation").at(name), 0.0, 1e-6) << name;
  }
  EXPECT_EQ(result.at("delta"), 2.0);
  EXPECT_EQ(result.at("delta_unit"), "s");
}

TEST_F(CommandLine, SummaryGivesTheTrackingRate) {
  const json by_number = runJson("summary -g truth.txt -e good.txt --frames 5");
  EXPECT_DOUBLE_EQ(by_number.at("tracking_rate"), 80.0);
  EXPECT_NEAR(by_number.at("ate").at("rmse"), 0.1, 1e-9);
  // From corner to corner the height changes by 0.2 m.
  EXPECT_NEAR(by_number.at("rpe").at("translation").at("rmse"), 0.2, 1e-9);

  TemporaryFolder::write("rgb.txt", "# rgb\n0.0 a.png\n1.0 b.png\n3.0 c.png\n7.0 d.png\n");
  const json by_list = runJson("summary -g truth.txt -e good.txt --associations rgb.txt");
  EXPECT_EQ(by_list.at("frames"), 4);
  EXPECT_EQ(by_list.at("frames_tracked"), 3);
  EXPECT_DOUBLE_EQ(by_list.at("tracking_rate"), 75.0);
}

TEST_F(CommandLine, RunsOfOneSystemHaveMedianAndSpread) {
  const json result = runJson("ate -g truth.txt -e good.txt better.txt bad.txt");
  ASSERT_EQ(result.at("runs").size(), 3U);
  EXPECT_EQ(result.at("runs")[1].at("file"), "better.txt");
  ASSERT_EQ(result.at("systems").size(), 1U);
  const json& rmse = result.at("systems")[0].at("rmse");
  EXPECT_NEAR(rmse.at("median"), 0.1, 1e-9);
  EXPECT_NEAR(rmse.at("min"), 0.05, 1e-9);
  EXPECT_NEAR(rmse.at("max"), 0.4, 1e-9);
  EXPECT_THAT(run("ate -g truth.txt -e good.txt better.txt bad.txt").output,
              HasSubstr("median of 3 runs"));
}

TEST_F(CommandLine, ImprovementIsAgainstTheMedianOfTheBaseline) {
  const std::string arguments =
      "ate -g truth.txt --baseline none=bad.txt none=good.txt none=bad.txt "
      "--estimate box=good.txt hmc=better.txt";
  const json result = runJson(arguments);
  const json& systems = result.at("systems");
  ASSERT_EQ(systems.size(), 3U);
  EXPECT_EQ(systems[0].at("system"), "none");
  EXPECT_FALSE(systems[0].contains("improvement"));
  EXPECT_NEAR(systems[1].at("improvement").at("rmse"), 75.0, 1e-6);
  EXPECT_NEAR(systems[2].at("improvement").at("rmse"), 87.5, 1e-6);
  const std::string table = run(arguments).output;
  EXPECT_THAT(table, HasSubstr("87.5 %"));
  EXPECT_THAT(table, HasSubstr("none, median of 3 runs"));
}

TEST_F(CommandLine, ScaleIsFittedOnDemand) {
  write("small.txt", test::resized(0.5, square(0.0)));
  EXPECT_NEAR(runJson("ate -g truth.txt -e small.txt").at("rmse"), std::sqrt(0.5), 1e-9);
  const json ate = runJson("ate -g truth.txt -e small.txt --scale");
  EXPECT_NEAR(ate.at("rmse"), 0.0, 1e-9);
  EXPECT_NEAR(ate.at("scale"), 2.0, 1e-9);
  const json rpe = runJson("rpe -g truth.txt -e small.txt --scale");
  EXPECT_NEAR(rpe.at("translation").at("rmse"), 0.0, 1e-9);
}

TEST_F(CommandLine, ToleranceAndOffsetReachTheAssociation) {
  write("late.txt", test::delayed(10.1, square(0.0)));
  EXPECT_EQ(run("ate -g truth.txt -e late.txt --offset -10").exit_code, 1);
  EXPECT_EQ(runJson("ate -g truth.txt -e late.txt --offset -10 --tolerance 0.15").at("pairs"), 4);
}

TEST_F(CommandLine, OutputGoesToAFile) {
  const ProcessResult result = run("ate -g truth.txt -e good.txt --json --output ate.json");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.output, "");
  EXPECT_EQ(json::parse(read(path("ate.json"))).at("pairs"), 4);
}

TEST_F(CommandLine, PlotShowsEachSystemInItsColourOnBothCharts) {
  std::mt19937 random(5);
  write("helix.txt", test::helix(300));
  write("first.txt", test::disturbed(test::helix(300), random));
  write("second.txt", test::disturbed(test::helix(300), random));
  const ProcessResult result =
      run("summary -g helix.txt --baseline none=first.txt -e hmc=second.txt --plot plot.png");
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  const cv::Mat picture = cv::imread(path("plot.png").string());
  ASSERT_EQ(picture.size(), cv::Size(1600, 800));

  // Below the legend, left and right.
  for (const cv::Rect& part : {cv::Rect(0, 60, 800, 740), cv::Rect(800, 60, 800, 740)}) {
    const auto countOf = [&](const cv::Scalar& colour) {
      cv::Mat mask;
      cv::inRange(picture(part), colour - cv::Scalar::all(40), colour + cv::Scalar::all(40), mask);
      return cv::countNonZero(mask);
    };
    EXPECT_GT(countOf({0, 94, 213}), 300) << "the first system's vermilion";
    EXPECT_GT(countOf({178, 114, 0}), 300) << "the second system's blue";
  }
}

TEST_F(CommandLine, HelpNamesUnitsAndAnExample) {
  for (const char* arguments : {"--help", "ate --help", "rpe --help", "summary --help"}) {
    const ProcessResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 0) << arguments;
    EXPECT_THAT(result.output, HasSubstr("hmcdyn_evaluate ate --groundtruth groundtruth.txt"));
  }
  EXPECT_THAT(run("rpe --help").output, HasSubstr("s (time), m (path), rad or deg"));
}

TEST_F(CommandLine, WrongUsageIsExitCode2) {
  for (const char* arguments :
       {"", "fly", "ate", "ate -g truth.txt", "ate -g truth.txt -e good.txt --fly",
        "ate -g truth.txt -e good.txt --tolerance -1", "rpe -g truth.txt -e good.txt --delta 0",
        "rpe -g truth.txt -e good.txt --delta-unit weeks",
        "rpe -g truth.txt -e good.txt --delta 1.5 --delta-unit frames",
        "summary -g truth.txt -e good.txt --frames 4 --associations rgb.txt",
        "ate -g truth.txt --baseline a=bad.txt b=bad.txt -e good.txt",
        "ate -g truth.txt --baseline a=bad.txt -e a=good.txt"}) {
    const ProcessResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 2) << arguments;
    EXPECT_EQ(result.output, "") << arguments;
    EXPECT_NE(result.errors, "") << arguments;
  }
}

TEST_F(CommandLine, UnusableDataIsExitCode1AndNamesTheFile) {
  TemporaryFolder::write("broken.txt", "0 0 0 0 0 0 0 1\n1 0 0\n");
  write("elsewhen.txt", test::delayed(1000.0, square(0.0)));
  const auto errorsOf = [&](const std::string& arguments) {
    const ProcessResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 1) << arguments;
    EXPECT_EQ(result.output, "") << arguments;
    return result.errors;
  };
  EXPECT_THAT(errorsOf("ate -g missing.txt -e good.txt"), HasSubstr("missing.txt: cannot be read"));
  EXPECT_THAT(errorsOf("ate -g truth.txt -e broken.txt"), HasSubstr("broken.txt:2: 3 fields"));
  EXPECT_THAT(errorsOf("ate -g truth.txt -e elsewhen.txt"),
              HasSubstr("elsewhen.txt: 0 of 4 poses lie within 0.02 s"));
  EXPECT_THAT(errorsOf("rpe -g truth.txt -e good.txt --delta 3"),
              HasSubstr("good.txt: 0 pairs of poses lie 3 s apart"));
  EXPECT_THAT(errorsOf("summary -g truth.txt -e good.txt --frames 3"),
              HasSubstr("good.txt: has 4 poses, more than the 3 frames"));
  EXPECT_THAT(errorsOf("summary -g truth.txt -e good.txt --associations missing.txt"),
              HasSubstr("missing.txt: cannot be read"));
  EXPECT_THAT(errorsOf("ate -g truth.txt -e good.txt --output missing/ate.txt"),
              HasSubstr("missing/ate.txt: cannot be written"));
}

TEST_F(CommandLine, APlotThatCannotBeWrittenIsExitCode1) {
  for (const char* file : {"missing/plot.png", "plot.unknown"}) {
    const ProcessResult result = run(std::string("ate -g truth.txt -e good.txt --plot ") + file);
    EXPECT_EQ(result.exit_code, 1) << file;
    EXPECT_THAT(result.errors, HasSubstr(std::string(file) + ": the picture cannot be written"));
  }
}

}  // namespace
}  // namespace hmcdyn::evaluate

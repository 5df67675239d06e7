// SPDX-License-Identifier: BSD-3-Clause
// What a thread throws costs its result and not the run.
#include "slam/run/part_errors.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "file_content.hpp"
#include "input/dataset/temporary_folder.hpp"
#include "invalid_argument.hpp"
#include "run/toy_sequence.hpp"
#include "slam/run/dense_mapper.hpp"
#include "slam/run/options.hpp"
#include "slam/run/run.hpp"
#include "slam/run/summary.hpp"

namespace hmcdyn::slam {
namespace {

using test::ToySequence;

TEST(PartErrors, TheFirstErrorOfAPartIsReportedAndAllAreCounted) {
  std::vector<std::string> reports;
  PartErrors errors([&](const std::string& message) { reports.push_back(message); });
  EXPECT_TRUE(errors.attempt("mapping", "it goes on", [] {}));
  EXPECT_FALSE(errors.attempt("mapping", "it goes on", [] { throw std::runtime_error("one"); }));
  EXPECT_FALSE(errors.attempt("loops", "it goes on", [] { throw 7; }));
  EXPECT_FALSE(errors.attempt("mapping", "it goes on", [] { throw std::logic_error("two"); }));
  ASSERT_EQ(errors.all().size(), 2U);
  EXPECT_EQ(errors.all()[0].part, "mapping");
  EXPECT_EQ(errors.all()[0].error, "one");
  EXPECT_EQ(errors.all()[0].times, 2U);
  EXPECT_EQ(errors.all()[1].error, "it threw what is no std::exception");
  ASSERT_EQ(reports.size(), 2U);
  EXPECT_EQ(reports[0],
            "mapping failed: one; it goes on; further failures of this part are only counted");
}

class RunWithErrors : public testing::Test {
 protected:
  SlamOptions optionsFor(const ToySequence& toy) const {
    test::writeToySequence(folder_.path() / "sequence", toy);
    SlamOptions options;
    options.dataset = folder_.path() / "sequence";
    options.camera = (options.dataset / "calibration.yaml").string();
    options.output = folder_.path() / "out";
    options.features.features = 400;
    options.quiet = true;
    return options;
  }

  std::string contentOf(const std::string& file) const {
    return hmcdyn::test::contentOf(folder_.path() / "out" / file);
  }

  /// All results are there, the summary as it was returned, with one part that failed.
  void expectOneError(const nlohmann::json& summary, const std::string& part,
                      const std::string& error) const {
    ASSERT_EQ(summary.at("errors").size(), 1U) << summary.at("errors");
    EXPECT_EQ(summary.at("errors")[0].at("part"), part);
    EXPECT_EQ(summary.at("errors")[0].at("error"), error);
    EXPECT_EQ(exitCodeOf(summary), 1);
    EXPECT_EQ(nlohmann::json::parse(contentOf("summary.json")), summary);
    EXPECT_NE(contentOf("report.html").find(part + " failed"), std::string::npos);
    EXPECT_FALSE(contentOf("keyframes.txt").empty());
    EXPECT_FALSE(contentOf("map.ply").empty());
    const std::string trajectory = contentOf("trajectory.txt");
    EXPECT_EQ(std::count(trajectory.begin(), trajectory.end(), '\n'),
              summary.at("counts").at("frames_tracked").get<int>());
    EXPECT_LT(summary.at("evaluation").at("ate_m").at("max").get<double>(), 0.003);
  }

  hmcdyn::test::TemporaryFolder folder_;
};

TEST_F(RunWithErrors, WithoutErrorsThereAreNoneAndTheExitCodeIsZero) {
  const nlohmann::json summary = runSlam(optionsFor({}));
  EXPECT_TRUE(summary.at("errors").empty());
  EXPECT_EQ(exitCodeOf(summary), 0);
}

TEST_F(RunWithErrors, LocalMappingThatThrowsCostsItsAdjustmentsOnly) {
  for (const std::size_t delay : {2U, 0U}) {  // as offline, as in real time
    ToySequence toy;
    toy.frames = 40;
    SlamOptions options = optionsFor(toy);
    options.mapping.adjustment.max_iterations = 0;
    options.mapping.delay = delay;
    const nlohmann::json summary = runSlam(options);
    expectOneError(summary, "local mapping", "options.max_iterations is 0, expected at least 1");
    EXPECT_EQ(summary.at("counts").at("frames_tracked"), 40);
    EXPECT_EQ(summary.at("counts").at("local_adjustments"), 0);
    EXPECT_GE(summary.at("errors")[0].at("times").get<int>(), 2) << "each key frame asks anew";
  }
}

TEST_F(RunWithErrors, ARelocalizationThatThrowsLeavesTheFrameLostAndTheNextIsFound) {
  ToySequence toy;
  toy.frames = 12;
  toy.spoil = [](int k, cv::Mat& color, cv::Mat&) {
    if (k == 6) {
      color.setTo(cv::Scalar::all(0));
    }
  };
  SlamOptions options = optionsFor(toy);
  options.loops.relocalizer.pnp_iterations = 0;
  const nlohmann::json summary = runSlam(options);
  expectOneError(summary, "relocalization", "options.pnp_iterations is 0, expected at least 1");
  EXPECT_EQ(summary.at("errors")[0].at("times"), 1);
  EXPECT_EQ(summary.at("counts").at("frames_tracked"), 11);
}

TEST_F(RunWithErrors, WhatTrackingThrowsInTheMiddleEndsTheFramesAndKeepsThem) {
  ToySequence toy;
  toy.frames = 10;
  int asked = 0;
  const auto breaks = [&asked]() -> bool {
    if (++asked > 5) {
      throw std::runtime_error("no memory left");
    }
    return false;
  };
  const nlohmann::json summary = runSlam(optionsFor(toy), breaks);
  expectOneError(summary, "tracking", "no memory left");
  EXPECT_EQ(summary.at("counts").at("frames_tracked"), 5);
}

TEST_F(RunWithErrors, WhatIsThrownBeforeAnythingIsTrackedIsTheCallers) {
  SlamOptions options = optionsFor({});
  options.filter.expert.stage.clustering.epsilon = -1.0f;
  options.detector.type = "file";
  options.detector.boxes = folder_.path() / "boxes.txt";
  std::ofstream(options.detector.boxes) << test::toyStamp(0) << " person 0 0 320 240 0.9\n";
  EXPECT_THROW(runSlam(options), std::invalid_argument);
}

TEST(ExitCode, IsZeroOnlyForARunThatIsWhole) {
  nlohmann::json good = {{"counts", {{"frames_tracked", 1}, {"write_failures", {}}}},
                         {"errors", nlohmann::json::array()}};
  good["counts"]["write_failures"] = nlohmann::json::array();
  EXPECT_EQ(exitCodeOf(good), 0);
  for (const auto& [place, value] : std::vector<std::pair<std::string, nlohmann::json>>{
           {"/counts/write_failures", {"map.ply: No space left on device"}},
           {"/errors", {{{"part", "tracking"}}}}}) {
    nlohmann::json bad = good;
    bad[nlohmann::json::json_pointer(place)] = value;
    EXPECT_EQ(exitCodeOf(bad), 1) << place;
  }
  good["counts"]["frames_tracked"] = 0;
  EXPECT_EQ(exitCodeOf(good), kFewPoses);
}

FrameOutcome keyFrame(int depth_type) {
  FrameOutcome outcome;
  outcome.image.bgr = cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(90));
  outcome.image.depth = cv::Mat(48, 64, depth_type, cv::Scalar::all(2));
  return outcome;
}

TEST(DenseMapperErrors, AKeyFrameThatThrowsIsLeftOutAndTheOthersMakeTheMap) {
  const PinholeCamera camera{60.0, 60.0, 31.5, 23.5};
  Map map(camera, {});
  DenseMapper mapper;
  mapper.add(0, keyFrame(CV_32F));
  mapper.finish();
  // Whether the thread is done with it before add() returns is a matter of chance.
  EXPECT_NE(hmcdyn::test::invalidArgumentOf([&] {
              mapper.add(1, keyFrame(CV_8U));
              mapper.finish();
            }),
            "nothing thrown");
  mapper.add(2, keyFrame(CV_32F));
  mapper.finish();
  for (std::size_t k = 0; k < 3; ++k) {
    Frame frame;
    frame.index = k;
    map.insertKeyFrame(std::move(frame));
  }
  EXPECT_FALSE(mapper.fuse(map).cloud.position.empty());
}

}  // namespace
}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#include "slam/run/run.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "file_content.hpp"
#include "input/dataset/temporary_folder.hpp"
#include "run/toy_sequence.hpp"
#include "slam/run/options.hpp"

namespace hmcdyn::slam {
namespace {

using hmcdyn::test::contentOf;
using hmcdyn::test::TemporaryFolder;
using test::ToySequence;
using test::writeToySequence;

std::size_t linesIn(const std::filesystem::path& file) {
  const std::string content = contentOf(file);
  return static_cast<std::size_t>(std::count(content.begin(), content.end(), '\n'));
}

class Run : public testing::Test {
 protected:
  SlamOptions optionsFor(const ToySequence& toy) {
    writeToySequence(folder_.path() / "sequence", toy);
    SlamOptions options;
    options.dataset = folder_.path() / "sequence";
    options.camera = (options.dataset / "calibration.yaml").string();
    options.output = folder_.path() / "out";
    options.features.features = 500;
    options.quiet = true;
    return options;
  }

  TemporaryFolder folder_;
};

TEST_F(Run, TracksACameraWithExactTruth) {
  const SlamOptions options = optionsFor({});
  const nlohmann::json summary = runSlam(options);
  EXPECT_EQ(summary.at("counts").at("frames_in"), 8);
  EXPECT_EQ(summary.at("counts").at("frames_tracked"), 8);
  EXPECT_DOUBLE_EQ(summary.at("counts").at("tracking_rate"), 1.0);
  EXPECT_LT(summary.at("evaluation").at("ate_m").at("rmse").get<double>(), 0.002);
  EXPECT_EQ(linesIn(options.output / "trajectory.txt"), 8U);
  EXPECT_EQ(linesIn(options.output / "timings.csv"), 9U);
  EXPECT_EQ(nlohmann::json::parse(contentOf(options.output / "summary.json")), summary);
}

TEST_F(Run, OneSeedGivesOneTrajectoryBitForBit) {
  SlamOptions options = optionsFor({});
  runSlam(options);
  const std::string first = contentOf(options.output / "trajectory.txt");
  options.output = folder_.path() / "again";
  runSlam(options);
  EXPECT_EQ(contentOf(options.output / "trajectory.txt"), first);
}

TEST_F(Run, KeyPointsAndPicturesAreWrittenOnRequest) {
  SlamOptions options = optionsFor({});
  options.max_frames = 2;
  options.write_keypoints = true;
  options.annotate = true;
  const nlohmann::json summary = runSlam(options);
  EXPECT_EQ(linesIn(options.output / "keypoints.csv"),
            summary.at("counts").at("key_points").get<std::size_t>() + 1);
  EXPECT_FALSE(cv::imread((options.output / "frames" / "000001.png").string()).empty());
}

TEST_F(Run, AFilterWithNothingToDoSaysSo) {
  SlamOptions options = optionsFor({});
  options.filter.rule = FilterRule::kBox;
  const nlohmann::json summary = runSlam(options);
  ASSERT_EQ(summary.at("warnings").size(), 1U);
  EXPECT_EQ(summary.at("warnings").front(),
            "the filter 'box' had nothing to do: there is no detector (--detector none)");
}

TEST_F(Run, TheRobustFilterNeedsNoDetectorToHaveSomethingToDo) {
  const nlohmann::json summary = runSlam(optionsFor({}));
  EXPECT_TRUE(summary.at("warnings").empty()) << summary.at("warnings");
  EXPECT_EQ(summary.at("counts").at("motion_masks").at("good"), 7);
}

TEST_F(Run, ADetectorThatFindsNothingIsReportedAllTheSame) {
  SlamOptions options = optionsFor({});
  options.detector.type = "file";
  options.detector.boxes = folder_.write("boxes.txt", "1000.0 chair 40 60 119 179 0.8\n");
  options.detector.classes = {0};
  const nlohmann::json summary = runSlam(options);
  ASSERT_FALSE(summary.at("warnings").empty());
  EXPECT_TRUE(hmcdyn::test::mentions(
      summary.at("warnings").back().get<std::string>(),
      {"without a box, only the motion mask spoke", "1 are of other classes than --classes"}));
}

TEST_F(Run, BoxesFromAFileReachTheFilter) {
  SlamOptions options = optionsFor({});
  options.detector.type = "file";
  options.detector.boxes = folder_.path() / "boxes.txt";
  std::ofstream boxes(options.detector.boxes);
  for (int k = 0; k < 8; ++k) {
    boxes << fmt::format("{:.6f} person 100 50 200 200 0.9\n", 1000.0 + k / 30.0);
  }
  boxes.close();
  const nlohmann::json summary = runSlam(options);
  EXPECT_EQ(summary.at("counts").at("boxes"), 8);
  EXPECT_EQ(summary.at("counts").at("dynamic_boxes"), 0);  // nothing in them moves
  EXPECT_TRUE(summary.at("warnings").empty());
}

TEST_F(Run, BoxesThatWereFoundAreWrittenAndReadAgain) {
  SlamOptions options = optionsFor({});
  options.max_frames = 3;
  options.write_boxes = true;
  options.detector.type = "file";
  options.detector.boxes = folder_.path() / "boxes.txt";
  std::ofstream(options.detector.boxes)
      << "1000.000000 person 100 50 200 200 0.9\n1000.066667 0 10.5 20.25 30 40 0.75\n";
  runSlam(options);
  EXPECT_EQ(contentOf(options.output / "boxes.txt"),
            "# timestamp class x_min y_min x_max y_max score\n"
            "1000 0 100 50 200 200 0.9\n1000.066667 0 10.5 20.25 30 40 0.75\n");
  options.detector.boxes = options.output / "boxes.txt";
  options.output = folder_.path() / "again";
  runSlam(options);
  EXPECT_EQ(contentOf(options.output / "boxes.txt"), contentOf(options.detector.boxes));
}

TEST_F(Run, ATruncatedPictureIsLeftOutAndCounted) {
  const SlamOptions options = optionsFor({});
  const auto broken = options.dataset / "rgb" / "1000.100000.png";
  std::filesystem::resize_file(broken, std::filesystem::file_size(broken) / 2);
  const nlohmann::json summary = runSlam(options);
  EXPECT_EQ(summary.at("counts").at("frames_unreadable"), 1);
  EXPECT_EQ(summary.at("counts").at("frames_tracked"), 7);
  EXPECT_EQ(linesIn(options.output / "trajectory.txt"), 7U);
}

TEST_F(Run, WithoutAnyDepthNoFrameIsTrackedAndTheReasonIsCounted) {
  ToySequence toy;
  toy.with_depth = false;
  const nlohmann::json summary = runSlam(optionsFor(toy));
  EXPECT_EQ(summary.at("counts").at("frames_tracked"), 0);
  EXPECT_EQ(summary.at("counts").at("tracking_failures").at("too few key points"), 8);
  EXPECT_TRUE(summary.at("evaluation").contains("error"));
}

TEST_F(Run, AMissingDataSetIsNamed) {
  SlamOptions options = optionsFor({});
  options.dataset = folder_.path() / "nowhere";
  const std::string message =
      hmcdyn::test::messageOf<std::runtime_error>([&] { runSlam(options); });
  EXPECT_NE(message.find("nowhere"), std::string::npos) << message;
}

TEST_F(Run, AnOutputThatIsAFileIsRefusedBeforeAnyWork) {
  SlamOptions options = optionsFor({});
  std::ofstream(options.output) << "in the way";
  EXPECT_THROW(runSlam(options), std::runtime_error);
}

TEST_F(Run, AModelThatIsAskedForAndMissingIsAnError) {
  SlamOptions options = optionsFor({});
  options.detector.type = "yolo";
  options.detector.model = folder_.path() / "missing.onnx";
  EXPECT_THROW(runSlam(options), std::runtime_error);
}

}  // namespace
}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#include "slam/output/report/report.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "slam/input/dataset/temporary_folder.hpp"
#include "slam/output/report/sample_run.hpp"
#include "slam/output/report/thin_frames.hpp"

namespace hmcdyn::slam {
namespace {

using test::mentions;
using test::messageOf;
using test::sampleRun;

TEST(Report, HeadlineFiguresByHand) {
  ReportInput input;
  input.stages = {"features", "track"};
  ReportFrame frame;
  frame.stage_ms = {10.0, 5.0};
  frame.error = 0.03;
  frame.static_points = 6;
  frame.dynamic_points = 2;
  input.frames.push_back(frame);
  frame.stage_ms = {20.0, std::nan("")};
  frame.error = 0.04;
  frame.failure = "too few matches";
  input.frames.push_back(frame);
  input.summary = {{"evaluation", {{"rpe_translation_m_per_s", {{"rmse", 0.0125}}}}}};
  const std::string html = renderReport(input);
  EXPECT_TRUE(
      mentions(html, {"0.0354 <small>m</small>",  // sqrt((9 + 16) / 2) cm
                      "0.0125 <small>m/s</small>", "1 <small>of 2</small>",
                      "17.5 <small>ms</small>", "25.0 <small>%</small>",
                      "<td>all stages</td><td class=\"n\">2</td><td class=\"n\">17.50</td>"}));
  input.summary["evaluation"]["ate_m"]["rmse"] = 0.5;
  EXPECT_TRUE(mentions(renderReport(input), {"0.5000 <small>m</small>"}))
      << "the summary's figure counts";
}

TEST(Report, IsOnePageThatLoadsNothing) {
  ReportInput input = sampleRun(20);
  input.pictures = {{"Frame 3", "foobar"}};
  const std::string html = renderReport(input);
  EXPECT_TRUE(
      mentions(html, {"default-src 'none'", "data:image/jpeg;base64,Zm9vYmFy", "Leon Sorokin"}));
  for (const char* outside : {"src=\"http", "href=", "@import", "url("}) {
    EXPECT_EQ(html.find(outside), std::string::npos) << outside;
  }
}

TEST(Report, PicturesBeyondTheBoundAreLeftOutAndCounted) {
  ReportInput input = sampleRun(2);
  input.pictures.assign(3, {"big", std::string(3'000'000, 'x')});
  const std::string html = renderReport(input);
  EXPECT_LT(html.size(), 9'000'000U);
  EXPECT_NE(html.find("1 more would make the page too large"), std::string::npos);
}

/// A run of 9000 frames with a peak of each kind, two lost frames and a closed loop.
ReportInput longRun() {
  ReportInput input = sampleRun(9000);
  for (ReportFrame& frame : input.frames) {
    frame.failure.clear();
    frame.error = 0.005;
    frame.position = frame.truth;
  }
  input.frames[1234].error = 0.5;
  input.frames[2345].stage_ms[4] = 400.0;
  input.frames[3456].dynamic_points = 5000;
  input.frames[4567].boxes = 17;
  input.frames[5678].static_points = 0;
  input.frames[6789].failure = "too few matches";
  input.frames[6790].failure = "too few matches";
  input.loops = {{input.frames[8017].timestamp, input.frames[33].timestamp, 0.1, 50, ""},
                 {input.frames[8019].timestamp, input.frames[37].timestamp, 0.1, 50, "clustered"}};
  return input;
}

TEST(FramesToShow, OfALongRunPeaksLossesAndLoopsStay) {
  const ReportInput input = longRun();
  const std::vector<std::size_t> shown = framesToShow(input);
  EXPECT_TRUE(std::is_sorted(shown.begin(), shown.end()));
  EXPECT_LE(shown.size(), kMostFramesShown + 1 + 2);
  for (const std::size_t frame :
       {0U, 33U, 1234U, 2345U, 3456U, 4567U, 5678U, 6789U, 8017U, 8999U}) {
    EXPECT_TRUE(std::binary_search(shown.begin(), shown.end(), frame)) << frame;
  }
  for (std::size_t k = 1; k < shown.size(); ++k) {
    EXPECT_LE(shown[k] - shown[k - 1], 30U) << "no stretch of 9000 / 300 frames is left out";
  }
}

TEST(FramesToShow, OfAShortRunAllStay) {
  EXPECT_EQ(framesToShow(sampleRun(kMostFramesShown)).size(), kMostFramesShown);
  EXPECT_TRUE(framesToShow(ReportInput{}).empty());
}

TEST(Report, OfALongRunDoesNotGrowAndSaysWhatItShows) {
  const ReportInput input = longRun();
  const std::string html = renderReport(input);
  EXPECT_LT(html.size(), 1'200'000U);
  EXPECT_TRUE(mentions(html, {"of 9000 frames: of each stretch", "8998 <small>of 9000</small>",
                              "<td>all stages</td><td class=\"n\">9000</td>"}));
  ReportInput twice = input;
  for (ReportFrame frame : input.frames) {
    frame.timestamp += 400.0;
    twice.frames.push_back(frame);
  }
  EXPECT_LT(static_cast<double>(renderReport(twice).size()),
            1.15 * static_cast<double>(html.size()));
  EXPECT_EQ(renderReport(sampleRun(100)).find("of each stretch"), std::string::npos);
}

TEST(Report, StageTimesOfAnotherCountAreRefused) {
  ReportInput input = sampleRun(3);
  input.frames[2].stage_ms.pop_back();
  EXPECT_EQ(messageOf<std::invalid_argument>([&] { renderReport(input); }),
            "report: frame 2 has 4 stage times; expected 5");
}

TEST(Report, IsWrittenInOneStepOrNotAtAll) {
  const test::TemporaryFolder folder;
  writeReport(folder.path() / "report.html", sampleRun(3));
  EXPECT_GT(std::filesystem::file_size(folder.path() / "report.html"), 60'000U);
  EXPECT_TRUE(mentions(messageOf<std::runtime_error>(
                           [&] { writeReport(folder.path() / "none" / "report.html", {}); }),
                       {"none/report.html", "No such file"}));
}

TEST(WithGroundTruth, AlignsPositionsAndFillsInErrors) {
  std::vector<ReportFrame> frames(3);
  for (std::size_t i = 0; i < 3; ++i) {
    frames[i].timestamp = 10.0 + static_cast<double>(i);
    frames[i].position = {static_cast<double>(i), 0.0, 0.0};
  }
  evaluate::AteResult result;
  result.alignment.translation = {0.0, 5.0, 0.0};
  result.timestamps = {10.0, 12.0000004};  // rounded in a file
  result.errors = {0.1, 0.2};
  result.groundtruth = {{0.1, 5.0, 0.0}, {2.2, 5.0, 0.0}};
  frames = withGroundTruth(frames, result);
  EXPECT_EQ(frames[0].position, Eigen::Vector3d(0.0, 5.0, 0.0));
  EXPECT_EQ(frames[1].position, Eigen::Vector3d(1.0, 5.0, 0.0));
  EXPECT_DOUBLE_EQ(frames[0].error, 0.1);
  EXPECT_TRUE(std::isnan(frames[1].error)) << "the truth has no pose of that time";
  EXPECT_DOUBLE_EQ(frames[2].error, 0.2);
  EXPECT_EQ(frames[2].truth, Eigen::Vector3d(2.2, 5.0, 0.0));
}

TEST(Report, OfALongRunTheCountsAreTheSummarys) {
  ReportInput input = sampleRun(100);
  EXPECT_EQ(renderReport(input).find("this page remembers"), std::string::npos);
  input.frames_in_all = 100000;
  input.summary = {{"counts", {{"frames_tracked", 99123}}}};
  const std::string page = renderReport(input);
  EXPECT_NE(page.find("99123 <small>of 100000</small>"), std::string::npos);
  EXPECT_NE(page.find("Of 100000 frames this page remembers 100,"), std::string::npos);
}

}  // namespace
}  // namespace hmcdyn::slam

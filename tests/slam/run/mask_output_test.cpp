// SPDX-License-Identifier: BSD-3-Clause
// --write-masks and --write-static-depth: a card that slides past a wall, and a camera with it.
#include <filesystem>
#include <set>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "input/dataset/temporary_folder.hpp"
#include "run/toy_sequence.hpp"
#include "slam/run/options.hpp"
#include "slam/run/run.hpp"
#include "slam/run/summary.hpp"

namespace hmcdyn::slam {
namespace {

using hmcdyn::test::mentions;
using hmcdyn::test::messageOf;

constexpr int kFrames = 14;
constexpr int kWithoutDepth = 9;  ///< The frame whose depth image is empty.

/// Where the card is seen; it is 1 m away.
cv::Rect cardAt(int frame) { return {20 + 12 * frame, 70, 70, 110}; }

class MaskOutput : public testing::Test {
 protected:
  MaskOutput() {
    test::ToySequence toy;
    toy.frames = kFrames;
    const cv::Mat print = test::makeTexture({70, 110}, 8);
    toy.spoil = [print](int frame, cv::Mat& color, cv::Mat& depth) {
      cv::cvtColor(print, color(cardAt(frame)), cv::COLOR_GRAY2BGR);
      depth(cardAt(frame)).setTo(5000);
      depth(cv::Rect(0, 0, 8, 240)).setTo(0);  // as sensors have it
      if (frame == kWithoutDepth) {
        depth.setTo(0);
      }
    };
    test::writeToySequence(sequence(), toy);
    options_.dataset = sequence();
    options_.camera = (sequence() / "calibration.yaml").string();
    options_.output = folder_.path() / "out";
    options_.write_masks = true;
    options_.write_static_depth = true;
    options_.write_report = false;
    options_.quiet = true;
  }

  std::filesystem::path sequence() const { return folder_.path() / "sequence"; }

  static std::set<std::string> namesIn(const std::filesystem::path& folder) {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      names.insert(entry.path().filename().string());
    }
    return names;
  }

  static cv::Mat read(const std::filesystem::path& folder, int frame) {
    return cv::imread((folder / (test::toyStamp(frame) + ".png")).string(), cv::IMREAD_UNCHANGED);
  }

  /// The masks and depths of frame 5 on, by when the card has left the place where it began.
  void expectTheCardIsMaskedOut() const {
    for (int frame = 6; frame < kFrames; ++frame) {
      const cv::Mat mask = read(options_.output / "masks", frame);
      const cv::Mat depth = read(options_.output / "static_depth", frame);
      const cv::Mat input = read(sequence() / "depth", frame);
      ASSERT_EQ(mask.type(), CV_8UC1) << frame;
      ASSERT_EQ(depth.type(), CV_16UC1) << frame;
      ASSERT_EQ(mask.size(), input.size()) << frame;
      if (frame == kWithoutDepth) {
        EXPECT_EQ(cv::countNonZero(mask != 64), 0) << "no depth: unknown everywhere";
        EXPECT_EQ(cv::countNonZero(depth), 0);
        continue;
      }
      const cv::Rect card = cardAt(frame);
      const cv::Rect inner(card.x + 8, card.y + 8, card.width - 16, card.height - 16);
      EXPECT_EQ(cv::countNonZero(mask(inner) != 255), 0) << frame;
      const cv::Rect wall(card.br().x + 20, 0, 320 - card.br().x - 20, 60);
      EXPECT_EQ(cv::countNonZero(mask(wall) == 255), 0) << frame;
      // To the pixel: what moves or may move is 0, all else as the camera measured it.
      cv::Mat expected = input.clone();
      expected.setTo(0, mask >= 128);
      EXPECT_EQ(cv::norm(depth, expected, cv::NORM_INF), 0.0) << frame;
    }
  }

  hmcdyn::test::TemporaryFolder folder_;
  SlamOptions options_;
};

TEST_F(MaskOutput, EachFrameHasAMaskAndADepthNamedByItsColourImage) {
  const nlohmann::json counts = runSlam(options_).at("counts");
  EXPECT_EQ(namesIn(options_.output / "masks"), namesIn(sequence() / "rgb"));
  EXPECT_EQ(namesIn(options_.output / "static_depth"), namesIn(sequence() / "rgb"));
  EXPECT_EQ(cv::countNonZero(read(options_.output / "masks", 0) != 64), 0)
      << "nothing to compare the first frame with";
  expectTheCardIsMaskedOut();
  EXPECT_EQ(counts.at("motion_masks").at("first frame"), 1);
  EXPECT_EQ(counts.at("motion_masks").at("no depth"), 1);
  EXPECT_EQ(counts.at("motion_masks").at("good"), kFrames - 2);
}

TEST_F(MaskOutput, TheSameInRealTime) {
  options_.mode = RunMode::kRealtime;
  options_.held_images = kFrames;  // none is dropped
  runSlam(options_);
  EXPECT_EQ(namesIn(options_.output / "masks"), namesIn(sequence() / "rgb"));
  EXPECT_EQ(namesIn(options_.output / "static_depth"), namesIn(sequence() / "rgb"));
  expectTheCardIsMaskedOut();
}

TEST_F(MaskOutput, WhatIsNotAskedForIsNotWritten) {
  options_.max_frames = 2;
  options_.write_static_depth = false;
  runSlam(options_);
  EXPECT_FALSE(std::filesystem::exists(options_.output / "static_depth"));
  EXPECT_EQ(namesIn(options_.output / "masks").size(), 2U);
  options_.output = folder_.path() / "other";
  options_.write_static_depth = true;
  options_.write_masks = false;
  runSlam(options_);
  EXPECT_FALSE(std::filesystem::exists(options_.output / "masks"));
  EXPECT_EQ(namesIn(options_.output / "static_depth").size(), 2U);
}

TEST_F(MaskOutput, AFilterThatMakesNoMaskIsRefusedBeforeAnyFileIsWritten) {
  const auto refusal = [&] { return messageOf<std::invalid_argument>([&] { runSlam(options_); }); };
  options_.filter.rule = FilterRule::kNone;
  EXPECT_TRUE(mentions(refusal(), {"--write-masks", "--filter none", "--filter robust"}));
  options_.filter.rule = FilterRule::kHmc;
  options_.write_masks = false;
  options_.filter.expert.use_belief = false;
  EXPECT_TRUE(mentions(refusal(), {"--write-static-depth", "--no-belief", "--filter robust"}));
  options_.filter = FrameFilterOptions::paper();
  options_.filter_name = "hmc";
  EXPECT_TRUE(mentions(refusal(), {"--filter hmc"}));
  options_.filter = FrameFilterOptions::robust();
  options_.ablation = Ablation::kRs;
  EXPECT_TRUE(mentions(refusal(), {"--ablation rs"}));
  EXPECT_FALSE(std::filesystem::exists(options_.output));
}

TEST_F(MaskOutput, MasksThatAreReadAreNotOverwritten) {
  options_.detector.type = "masks";
  options_.detector.masks = options_.output / "." / "masks";
  EXPECT_TRUE(mentions(messageOf<std::invalid_argument>([&] { runSlam(options_); }),
                       {"--write-masks", "--masks", "--output"}));
}

TEST_F(MaskOutput, AMaskThatCannotBeWrittenEndsTheRunWithItsName) {
  const std::string name = test::toyStamp(3) + ".png";
  std::filesystem::create_directories(options_.output / "masks" / name / "full");
  const nlohmann::json summary = runSlam(options_);
  ASSERT_FALSE(summary.at("counts").at("write_failures").empty());
  EXPECT_TRUE(mentions(summary.at("counts").at("write_failures").front().get<std::string>(),
                       {"masks", name}));
  EXPECT_NE(exitCodeOf(summary), 0);
}

}  // namespace
}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
// Kind 2: boxes that cannot be boxes are refused or counted by rule, with a guess of what they are.
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "fault_input.hpp"
#include "slam/detect/box_plausibility.hpp"
#include "slam/detect/coco_classes.hpp"
#include "slam/detect/file_detector.hpp"

namespace hmcdyn::faults {
namespace {

using hmcdyn::test::mentions;
using hmcdyn::test::messageOf;
using slam::BoxReview;

class Boxes : public testing::Test {
 protected:
  /// Frames of 640 x 480 px from 1000 s on, 30 a second for 2 s; people are asked for.
  Boxes() {
    options_.classes = {0};
    options_.frames.image = {640, 480};
    for (int k = 0; k < 60; ++k) {
      options_.frames.times.push_back(1000.0 + k / 30.0);
    }
  }

  BoxReview review(const std::string& text) const {
    const std::filesystem::path file = folder_.write("boxes.txt", text);
    return slam::reviewBoxFile(file, options_);
  }
  std::string refusal(const std::string& text) const {
    return messageOf<std::runtime_error>([&] { review(text); });
  }

  slam::DetectorOptions options_;
  hmcdyn::test::TemporaryFolder folder_;
};

TEST_F(Boxes, AFileOfOtherBoxesIsRefusedWithAGuess) {
  struct Kind {
    const char* what;
    const char* text;
    std::vector<std::string> said;
  };
  const std::vector<Kind> kinds{
      {"x y width height",
       "1000.0 person 300 200 100 250 0.9\n1000.033333 person 310 210 110 240 0.9\n",
       {"2 of 2 lines", "x y width height"}},
      {"some of them are not inverted",
       "1000 person 300 200 100 250 1\n1000 person 20 30 90 200 1\n1000 person 310 40 90 200 1\n",
       {"2 of 3 lines", "x y width height"}},
      {"centre and size, too large for a corner",
       "1000.0 person 500 300 180 320 0.9\n1000.1 person 540 320 160 300 0.9\n",
       {"centre and size"}},
      {"x_min x_max y_min y_max",
       "1000.0 person 300 400 90 430 0.9\n1000.1 person 310 410 95 440 0.9\n",
       {"x_min x_max y_min y_max"}},
      {"of which some are not inverted",
       "1000.0 person 50 150 90 430 1\n1000.1 person 310 410 95 440 1\n1000.1 person 320 410 95 "
       "440 1\n",
       {"2 of 3 lines", "x_min x_max y_min y_max"}},
      {"corners in another order",
       "1000.0 person 600 470 300 200 0.9\n1000.1 person 610 460 310 210 0.9\n",
       {"x_max y_max x_min y_min"}},
      {"x_min and x_max exchanged",
       "1000.0 person 400 90 300 430 0.9\n1000.1 person 600 95 500 440 0.9\n",
       {"x_max y_min x_min y_max"}},
      {"y_min and y_max exchanged",
       "1000.0 person 300 430 400 90 0.9\n1000.1 person 500 440 600 95 0.9\n",
       {"x_min y_max x_max y_min"}},
      {"corners in any order",
       "1000.0 person 400 90 300 430 0.9\n1000.1 person 500 440 600 95 0.9\n",
       {"in no one order", "the smaller x"}},
      {"shares", "1000.0 person 0.3 0.2 0.5 0.9 0.9\n", {"shares of the image", "640 and 480"}},
      {"YOLO's shares", "1000.0 0 0.6 0.5 0.2 0.4 0.9\n", {"shares", "centre and size"}},
      {"another image", "1000.0 person 1200 700 1500 900 0.9\n", {"another size than 640 x 480"}},
      {"another clock",
       "12.0 person 10 20 90 200 0.9\n",
       {"no box is at a frame's time", "12.0", "differ by 988.000 s: the frames are ahead"}},
      {"without area",
       "1000.0 person 10 20 10 200 0.9\n",
       {"1 with a maximum not above", "no area"}},
      {"between the frames",
       "1001.9 person 10 20 90 200 0.9\n1002.5 person 10 20 90 200 0.9\n",
       {}},
      {"after the last frame", "1002.1 person 10 20 90 200 0.9\n", {"no box is within 0.02 s"}},
  };
  for (const Kind& kind : kinds) {
    SCOPED_TRACE(kind.what);
    if (kind.said.empty()) {
      EXPECT_EQ(review(kind.text).kept.size(), 1U);
      continue;
    }
    const std::string message = refusal(kind.text);
    EXPECT_TRUE(mentions(message, {"boxes.txt"}));
    for (const std::string& part : kind.said) {
      EXPECT_TRUE(mentions(message, {part}));
    }
  }
}

TEST_F(Boxes, EachRuleThatLeavesOutABoxIsCounted) {
  const BoxReview boxes = review(
      "1000.0 person 10 20 90 200 0.9\n"
      "1000.1 person 10 20 90 200 0.9\n"
      "1000.2 person 10 20 90 200 0.9\n"
      "1000.3 person 90 20 10 200 0.9\n"
      "1000.3 person 0.1 0.1 0.5 0.9 0.9\n"
      "1000.4 person 700 20 800 200 0.9\n"
      "1000.5 chair 10 20 90 200 0.9\n"
      "1000.5 bicycle 10 20 90 200 0.1\n"
      "1000.6 person 10 20 90 200 0.2\n"
      "1099.0 person 10 20 90 200 0.9\n");
  EXPECT_EQ(boxes.counts.in_file, 10U);
  EXPECT_EQ(boxes.counts.kept, 3U);
  EXPECT_EQ(boxes.kept.size(), 3U);
  EXPECT_EQ(boxes.counts.inverted, 1U);
  EXPECT_EQ(boxes.counts.shares, 1U);
  EXPECT_EQ(boxes.counts.outside, 1U);
  EXPECT_EQ(boxes.counts.other_class, 2U);
  EXPECT_EQ(boxes.counts.low_score, 1U);
  EXPECT_EQ(boxes.counts.other_time, 1U);
  EXPECT_TRUE(oneMentions(boxes.notes, {"7 of 10 boxes are left out", "1 outside the image",
                                        "2 of classes", "1 with a score below"}));
}

TEST_F(Boxes, OfThousandsAtOneTimeTheStrongestStay) {
  // 1000 boxes of rising score at one time, and one box at a later one
  std::string text = "1000.1 person 10 20 90 200 0.3\n";
  for (int i = 0; i < 1000; ++i) {
    text += fmt::format("1000.0 person {} {} {} 200 {:.4f}\n", i % 300, i % 100, i % 300 + 90,
                        0.3 + 0.0005 * i);
  }
  const BoxReview boxes = review(text);
  EXPECT_EQ(boxes.counts.weaker, 700U);
  ASSERT_EQ(boxes.kept.size(), 301U);
  EXPECT_NEAR(boxes.kept[0].box.score, 0.65f, 1e-4f);
  EXPECT_NEAR(boxes.kept[299].box.score, 0.7995f, 1e-4f);
  EXPECT_EQ(boxes.kept[300].timestamp, 1000.1);
  EXPECT_TRUE(oneMentions(boxes.notes, {"700 of 1001 boxes are left out",
                                        "700 beyond the 300 strongest of their time stamp"}));
}

TEST_F(Boxes, NothingIsSaidOfAFileWithBoxesOfOtherThingsAsDetectorsWriteThem) {
  EXPECT_TRUE(review("1000.0 person 10 20 90 200 0.9\n1000.0 chair 1 2 30 40 0.1\n").notes.empty());
  EXPECT_TRUE(review("").notes.empty());
}

TEST_F(Boxes, WhereNoneIsLeftTheRuleAndTheFilesClassesAreNamed) {
  EXPECT_TRUE(oneMentions(review("1000.0 1 10 20 90 200 0.9\n").notes,
                          {"1 of 1 boxes", "1 of classes", "1 (bicycle)"}));
  EXPECT_TRUE(oneMentions(review("1000.0 0 10 20 90 200 0.2\n").notes,
                          {"1 with a score below --score-threshold 0.25"}));
}

TEST_F(Boxes, FrameNumbersAndBoxesOfALargerImageAreNamed) {
  std::string numbers;
  std::string larger;
  for (int k = 0; k < 30; ++k) {
    numbers += fmt::format("{} person 10 20 90 200 0.9\n", k);
    larger += fmt::format("{:.6f} person 500 300 900 800 0.9\n", 1000.0 + k / 30.0);
  }
  EXPECT_TRUE(mentions(refusal(numbers), {"no box is at a frame's time", "frame numbers"}));
  EXPECT_TRUE(oneMentions(review(larger).notes, {"30 of 30 boxes", "640 x 480", "another size"}));
}

TEST_F(Boxes, ASizeThatStaysWhileTheCornerMovesMayBeASize) {
  std::string sizes;
  std::string corners;
  for (int k = 0; k < 20; ++k) {
    const double time = 1000.0 + k / 30.0;
    sizes += fmt::format("{:.6f} person {} 90 140 340 0.9\n", time, 10 + 6 * k);
    corners += fmt::format("{:.6f} person {} 90 {} 340 0.9\n", time, 10 + 6 * k, 150 + 6 * k);
  }
  EXPECT_TRUE(oneMentions(review(sizes).notes, {"x y width height", "are they sizes"}));
  EXPECT_TRUE(review(corners).notes.empty());
}

TEST_F(Boxes, ThoseOfAnImageOfHalfTheSizeAreNamed) {
  std::string half;
  std::string aside;
  for (int k = 0; k < 25; ++k) {
    const double time = 1000.0 + k / 30.0;
    half += fmt::format("{:.6f} person {} 40 {} 225 0.9\n", time, 10 + 9 * k, 80 + 9 * k);
    aside += fmt::format("{:.6f} person {} 40 {} 225 0.9\n", time, 10 + 2 * k, 80 + 2 * k);
  }
  EXPECT_TRUE(oneMentions(review(half).notes, {"upper left quarter", "half the size"}));
  EXPECT_TRUE(review(aside).notes.empty());
}

TEST_F(Boxes, SeveralAroundOnePersonAtOneTimeAreNamed) {
  std::string rounded;
  std::string crowd;
  for (int k = 0; k < 20; ++k) {
    rounded += fmt::format("{} person {} 90 {} 430 0.9\n", 1000 + k / 10, 50 + k, 190 + k);
    crowd += fmt::format("1000.5 person {} 90 {} 430 0.9\n", 10 + 30 * k, 60 + 30 * k);
  }
  EXPECT_TRUE(oneMentions(review(rounded).notes, {"18 of 20 boxes", "rounded", "NMS"}));
  EXPECT_TRUE(review(crowd).notes.empty());
}

TEST_F(Boxes, OneTimeStampForAllOfAnotherClockIsNamed) {
  std::string text;
  for (int k = 0; k < 9; ++k) {
    text += fmt::format("1024 person {} 90 {} 430 0.9\n", 50 + 60 * k, 100 + 60 * k);
  }
  EXPECT_TRUE(mentions(refusal(text), {"no box is at a frame's time", "are the same", "32 bits"}));
}

TEST_F(Boxes, WhatIsAssumedOfTheTextIsNoted) {
  EXPECT_TRUE(
      oneMentions(review("time class x1 y1 x2 y2 score\n1000,0 person 10 20 90 200 0,9\n").notes,
                  {"boxes.txt:1:", "names"}));
  EXPECT_TRUE(oneMentions(review("1000,0 person 10 20 90 200 0,9\n").notes, {"decimal commas"}));
}

TEST_F(Boxes, NamesOfClassesAreReadInAnySpelling) {
  for (const char* name : {"person", "Person", "PERSON", "\"person\"", "'Person'", "person:"}) {
    EXPECT_EQ(review(fmt::format("1000.0 {} 10 20 90 200 0.9\n", name)).kept.size(), 1U) << name;
  }
  EXPECT_EQ(slam::findCocoClass("Traffic-Light"), 9);
  EXPECT_EQ(slam::findCocoClass("\"TV\""), 62);
  for (const char* other : {"people", "pedestrian", "", "\"\"", ":"}) {
    EXPECT_FALSE(slam::findCocoClass(other).has_value()) << other;
  }
}

TEST_F(Boxes, PeopleThatLieInEveryFrameMayBeCornersWithYFirst) {
  const auto inFrames = [](const char* corners) {
    std::string text;
    for (int k = 0; k < 6; ++k) {
      text += fmt::format("{:.6f} person {} 0.9\n", 1000.0 + k / 30.0, corners);
    }
    return text;
  };
  EXPECT_TRUE(oneMentions(review(inFrames("60 250 470 420")).notes,
                          {"6 of the 6 boxes of people", "y_min x_min y_max x_max"}));
  EXPECT_TRUE(review(inFrames("250 60 420 470")).notes.empty());
  EXPECT_TRUE(review(inFrames("20 250 620 420")).notes.empty());  // not below 480 px with y first
}

TEST_F(Boxes, StampsInAnotherUnitAreThoseOfTheFramesTheyFit) {
  for (const char* stamp : {"1000100", "1000100000", "1000100000000"}) {
    const BoxReview boxes = review(std::string(stamp) + " person 10 20 90 200 0.9\n");
    ASSERT_EQ(boxes.kept.size(), 1U) << stamp;
    EXPECT_NEAR(boxes.kept[0].timestamp, 1000.1, 1e-6);
    EXPECT_TRUE(oneMentions(boxes.notes, {"fits the frames"}));
    EXPECT_TRUE(mentions(boxes.notes.front(), {"are read as", "seconds"}));
  }
}

TEST_F(Boxes, ALineOfAnotherFormatIsNamedWithAGuess) {
  struct Kind {
    const char* text;
    std::vector<std::string> said;
  };
  for (const Kind& kind : std::vector<Kind>{
           {"1000.0 10 20 90 200 0.9\n", {"boxes.txt:1: 6 fields", "class missing"}},
           {"0 0.5 0.5 0.2 0.4\n", {"boxes.txt:1: 5 fields", "YOLO"}},
           {"1000.0 person 10 20 90 200\n", {"boxes.txt:1: 6 fields", "score missing"}},
           {"1,-1,794,247,71,174,1,-1,-1,-1\n", {"boxes.txt:1:", "MOT"}},
           {"1000.0 10 20 90 200 0.9 person\n", {"boxes.txt:1:", "'person', is behind the score"}},
           {"0 0.5 0.5 0.2 0.4 0.9\n", {"boxes.txt:1: 6 fields", "YOLO"}},
           {"1,1,794,247,71,174,1,1,1.0\n", {"boxes.txt:1:", "MOT"}},
           {"2012-07-09T15:07:14 person 1 2 3 4 1\n", {"boxes.txt:1: timestamp is", "date"}},
           {"1000.0 person 10 20 90 200 95\n", {"boxes.txt:1: score is 95", "per cent"}},
           {"1000.0 0 0.85 10 20 90 200\n",
            {"boxes.txt:1: score is 200", "stand before the corners", "It comes last"}},
           {"0,10.5,20.5,90.5,200.5,0.85,0,person\n",
            {"boxes.txt:1: 8 fields", "timestamp class x_min", "score class name"}},
           {"1000.0 traffic 10 20 90 200 0.9 1\n", {"boxes.txt:1: 8 fields"}},
           {"Pedestrian 0.00 0 -0.20 10 20 90 200 1.8 0.5 1.2 1.8 1.4 8.4 0.01\n",
            {"boxes.txt:1: 15 fields, the first 'Pedestrian'", "KITTI"}},
           {"[\n{\"image_id\": 1, \"bbox\": [1, 2, 3, 4]}\n]\n",
            {"boxes.txt:1: 1 fields", "timestamp class x_min", "JSON"}},
           {"[{\"image_id\": 1, \"bbox\": [1, 2, 3, 4], \"score\": 0.5}]\n",
            {"boxes.txt:1:", "JSON"}},
           {"<?xml version=\"1.0\"?>\n", {"boxes.txt:1: 2 fields", "XML"}},
           {"rgb/1.png person 10 20 90 200 1\n",
            {"boxes.txt:1: timestamp is 'rgb/1.png'", "file's name"}}}) {
    const std::string message = refusal(kind.text);
    for (const std::string& part : kind.said) {
      EXPECT_TRUE(mentions(message, {part}));
    }
  }
}

}  // namespace
}  // namespace hmcdyn::faults

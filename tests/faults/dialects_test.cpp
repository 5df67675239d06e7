// SPDX-License-Identifier: BSD-3-Clause
// Kind 7: tables as other programs write them.
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "evaluate/trajectory.hpp"
#include "fault_input.hpp"
#include "slam/dataset/tum_dataset.hpp"
#include "slam/detection/file_detector.hpp"
#include "support/text_table.hpp"

namespace hmcdyn::faults {
namespace {

using hmcdyn::test::mentions;
using hmcdyn::test::messageOf;

/// A text, and what programs and systems make of it.
struct Dialect {
  const char* what;
  std::string text;
};

std::vector<Dialect> dialectsOf(const std::string& text) {
  return {{"as documented", text},
          {"a BOM", "\xEF\xBB\xBF" + text},
          {"two BOMs, as of joined files",
           "\xEF\xBB\xBF"
           "# first\n\xEF\xBB\xBF" +
               text},
          {"UTF-16, little endian", utf16(text, false)},
          {"UTF-16, big endian", utf16(text, true)},
          {"UTF-16 without its mark", utf16(text, false).substr(2)},
          {"CRLF", replaced(text, "\n", "\r\n")},
          {"CR", replaced(text, "\n", "\r")},
          {"tabs with CRLF, no final newline",
           replaced(replaced(text.substr(0, text.size() - 1), " ", "\t"), "\n", "\r\n")},
          {"trailing blanks and tabs", replaced(text, "\n", " \t \n")},
          {"no-break spaces", replaced(text, " ", "\xC2\xA0")},
          {"blank lines and comments of other kinds",
           "% Matlab\n// C\n\n   \n" + replaced(text, "\n", "\n\n")},
          {"a plus", replaced(text, "1.5", "+1.5")},
          {"a typographic minus", replaced(text, "-", "\xE2\x88\x92")},
          {"commas", replaced(text, " ", ",")},
          {"commas with blanks", replaced(text, " ", ", ")},
          {"semicolons", replaced(text, " ", ";")},
          {"decimal commas", replaced(text, ".", ",")},
          {"decimal commas with semicolons", replaced(replaced(text, " ", ";"), ".", ",")}};
}

class Dialects : public testing::Test {
 protected:
  hmcdyn::test::TemporaryFolder folder_;
};

TEST_F(Dialects, OfTrajectoriesAreRead) {
  for (const Dialect& dialect : dialectsOf("1.5 1.5 -2.25 0.5 0.0 0.0 0.0 1.0\n"
                                           "2.5 1.5 -2.25 1.5 0.0 0.0 0.0 1.0\n")) {
    SCOPED_TRACE(dialect.what);
    const evaluate::Trajectory poses =
        evaluate::readTrajectory(folder_.write("poses.txt", dialect.text));
    ASSERT_EQ(poses.size(), 2U);
    EXPECT_EQ(poses[0].timestamp, 1.5);
    EXPECT_EQ(poses[1].pose.translation(), Eigen::Vector3d(1.5, -2.25, 1.5));
  }
}

TEST_F(Dialects, OfBoxesAreRead) {
  for (const Dialect& dialect : dialectsOf("1.5 person 1.5 -2.25 30.5 40.5 0.5\n"
                                           "2.5 56 1.5 -2.25 30.5 40.5 0.5\n")) {
    SCOPED_TRACE(dialect.what);
    const std::vector<slam::TimedBox> boxes =
        slam::readBoxFile(folder_.write("boxes.txt", dialect.text));
    ASSERT_EQ(boxes.size(), 2U);
    EXPECT_EQ(boxes[0].timestamp, 1.5);
    EXPECT_EQ(boxes[0].box.y_min, -2.25f);
    EXPECT_EQ(boxes[1].box.class_id, 56);
    EXPECT_EQ(boxes[1].box.score, 0.5f);
  }
}

TEST_F(Dialects, OfListsAreRead) {
  for (const Dialect& dialect : dialectsOf("1.5 a 1.5 b\n1.75 b 1.75 a\n")) {
    SCOPED_TRACE(dialect.what);
    folder_.write("a", "");
    folder_.write("b", "");
    folder_.write("associations.txt", dialect.text);
    const std::vector<slam::FrameEntry> frames = slam::listFrames(folder_.path());
    ASSERT_EQ(frames.size(), 2U);
    EXPECT_EQ(frames[0].timestamp, 1.5);
    EXPECT_EQ(frames[1].rgb, folder_.path() / "b");
  }
}

TEST_F(Dialects, OfFileNamesAreReadWhereThereIsNoFileOfTheNameAsItIsWritten) {
  const std::string image = folder_.write("rgb/1.png", "").string();
  folder_.write("depth/1.png", "");
  for (const char* line :
       {"1.5 rgb\\1.png 1.5 depth\\1.png\n", "1.5 \"rgb/1.png\" 1.5 'depth/1.png'\n",
        "1.5 \"rgb\\1.png\" 1.5 depth/1.png\n"}) {
    folder_.write("associations.txt", line);
    const std::vector<slam::FrameEntry> frames = slam::listFrames(folder_.path());
    ASSERT_EQ(frames.size(), 1U);
    EXPECT_EQ(frames[0].rgb, image) << line;
  }
  const std::string odd = folder_.write("rgb\\1.png", "").string();
  folder_.write("associations.txt", "1.5 rgb\\1.png 1.5 depth/1.png\n");
  EXPECT_EQ(slam::listFrames(folder_.path())[0].rgb, odd);
}

TEST_F(Dialects, WhatIsAssumedIsNoted) {
  EXPECT_TRUE(oneMentions(evaluate::parseTrajectory("0,5 1,5 2 3 0 0 0 1\n", "poses.txt").notes,
                          {"poses.txt", "decimal commas"}));
  EXPECT_TRUE(oneMentions(
      evaluate::parseTrajectory("timestamp tx ty tz qx qy qz qw\n1 0 0 0 0 0 0 1\n", "poses.txt")
          .notes,
      {"poses.txt:1: 'timestamp ...'", "names"}));
  EXPECT_TRUE(
      evaluate::parseTrajectory("# header\n1.5 0 0 0 0 0 0 1\n", "poses.txt").notes.empty());
}

TEST_F(Dialects, CommasThatSeparateAndPointAreNamed) {
  const std::string text = "1,5,1,5,2,25,3,5,0,0,0,0,0,0,1,0\n";
  EXPECT_TRUE(
      mentions(messageOf<std::runtime_error>([&] { evaluate::parseTrajectory(text, "poses.txt"); }),
               {"poses.txt:1: 16 fields", "decimal commas ('1,5')"}));
  EXPECT_TRUE(mentions(
      messageOf<std::runtime_error>([&] { evaluate::parseTrajectory("1,5\n", "poses.txt"); }),
      {"poses.txt:1: 2 fields"}));
}

TEST_F(Dialects, APoseThatIsNoneIsLeftOutAndCounted) {
  for (const char* line : {"2 nan 0 0 0 0 0 1\n", "2 0 0 0 0 0 0 0\n", "2 0 0 inf 0 0 0 1\n",
                           "2 0 0 0 NaN NaN NaN NaN\n", "2 0 0 0 -nan 0 0 1\n"}) {
    const evaluate::NotedTrajectory read = evaluate::parseTrajectory(
        std::string("1 0 0 0 0 0 0 1\n") + line + "3 0 0 0 0 0 0 1\n", "poses.txt");
    EXPECT_EQ(read.poses.size(), 2U) << line;
    EXPECT_TRUE(oneMentions(read.notes, {"1 of 3 lines are left out", "line 2"}));
  }
}

TEST_F(Dialects, QuaternionsFarFromNormOneAreNormalisedAndSaid) {
  const evaluate::NotedTrajectory read =
      evaluate::parseTrajectory("1 0 0 0 0 0 0 3\n2 0 0 0 0 0 0 1.01\n", "poses.txt");
  EXPECT_TRUE(read.poses[0].pose.linear().isIdentity(1e-12));
  EXPECT_TRUE(oneMentions(read.notes, {"1 of 2 quaternions", "line 1"}));
}

TEST_F(Dialects, StampsThatRepeatAreSaid) {
  std::string text;
  for (int i = 0; i < 90; ++i) {
    text += std::to_string(7 + i / 30) + " 0 0 0 0 0 0 1\n";
  }
  const evaluate::NotedTrajectory read = evaluate::parseTrajectory(text, "poses.txt");
  EXPECT_EQ(read.poses.size(), 3U);
  EXPECT_TRUE(oneMentions(read.notes, {"87 of 90 lines repeat", "rounded to seconds"}));
}

TEST_F(Dialects, WhatIsNoTextIsNamed) {
  const std::string bytes("1 2\0\1\2\0", 6);
  EXPECT_TRUE(mentions(messageOf<std::runtime_error>([&] { support::toText(bytes, "list.txt"); }),
                       {"list.txt", "not a binary file"}));
  EXPECT_TRUE(mentions(messageOf<std::runtime_error>(
                           [] { support::parseFinite("a\xFF\x01", "time stamp", "list.txt", 3); }),
                       {"list.txt:3: time stamp is 'a\\xFF\\x01'"}));
}

TEST_F(Dialects, NumbersAreThoseOfEveryLocaleButTheWrongOnesAreNot) {
  double value = 0.0;
  for (const char* good : {"+1.5", "1.5e0", "15e-1", "1.50"}) {
    EXPECT_TRUE(support::parseNumber(good, value)) << good;
    EXPECT_EQ(value, 1.5);
  }
  for (const char* bad : {"", "+", "++1", "+-1", "1.5x", "1,5", "0x10", "1e999"}) {
    EXPECT_FALSE(support::parseNumber(bad, value)) << bad;
  }
}

}  // namespace
}  // namespace hmcdyn::faults

// SPDX-License-Identifier: BSD-3-Clause
// Kind 7: tables as other programs write them.
#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "evaluate/pose_convention.hpp"
#include "evaluate/trajectory.hpp"
#include "fault_input.hpp"
#include "slam/detect/file_detector.hpp"
#include "slam/input/dataset/tum_dataset.hpp"
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
          {"CR, behind a comment with LF", "# joined\n" + replaced(text, "\n", "\r")},
          {"CR CR LF", replaced(text, "\n", "\r\r\n")},
          {"line separators of Unicode", replaced(text, "\n", "\xE2\x80\xA8")},
          {"UTF-16 without its mark, a comment in another script",
           std::string("#\0 \0\x2D\x4E\n\0", 8) + utf16(text, false).substr(2)},
          {"zeros behind it, as of a file that was not closed", text + std::string(64, '\0')},
          {"DOS's end of file", text + "\x1A"},
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

TEST_F(Dialects, OfFileNamesWithoutTheirFolderAreReadFromItAndSaid) {
  const std::string color = folder_.write("rgb/1.png", "").string();
  const std::string depth = folder_.write("depth/1.png", "").string();
  folder_.write("associations.txt", "1.5 1.png 1.5 1.png\n");
  const slam::FrameList list = slam::readFrameList(folder_.path());
  EXPECT_EQ(list.frames[0].rgb, color);
  EXPECT_EQ(list.frames[0].depth, depth);
  EXPECT_TRUE(oneMentions(list.notes, {"1 files are listed without their folder", "rgb/"}));
  EXPECT_TRUE(oneMentions(list.notes, {"1 files are listed without their folder", "depth/"}));
  const std::string beside = folder_.write("1.png", "").string();  // as it is written
  EXPECT_EQ(slam::listFrames(folder_.path())[0].rgb, beside);
}

TEST_F(Dialects, ACommentBehindARowIsCut) {
  const evaluate::Trajectory poses =
      evaluate::parseTrajectory("1.5 1 2 3 0 0 0 1  # key frame\n2.5 1 2 3 0 0 0 1\t#\n", "p")
          .poses;
  EXPECT_EQ(poses.size(), 2U);
  folder_.write("a#1.png", "");
  folder_.write("associations.txt", "1.5 a#1.png 1.5 a#1.png # good\n");
  EXPECT_EQ(slam::listFrames(folder_.path())[0].rgb, folder_.path() / "a#1.png");
}

TEST_F(Dialects, MarkupInPlaceOfATableIsNamed) {
  for (const auto& markup :
       {std::pair("{\n  \"counts\": {}\n}\n", "JSON"),
        std::pair("[[1, 2, 3],\n[4, 5, 6]]\n", "JSON"), std::pair("<!DOCTYPE html>\n", "XML")}) {
    EXPECT_TRUE(mentions(messageOf<std::runtime_error>(
                             [&] { evaluate::parseTrajectory(markup.first, "poses.txt"); }),
                         {"poses.txt:1:", "expected 8", markup.second}));
  }
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

TEST_F(Dialects, OtherFormatsOfPosesAreNamed) {
  struct Kind {
    const char* line;
    const char* said;
  };
  for (const Kind& kind : std::vector<Kind>{{"1 0 0 0 0 1 0 0 0 0 1 0\n", "KITTI"},
                                            {"7 1 0 0 0 0 1 0 0 0 0 1 0\n", "KITTI"},
                                            {"1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1\n", "4 x 4"},
                                            {"1 0 0 0\n", "without its rotation"},
                                            {"1.5 0 0 0 10 20 30\n", "angles"},
                                            {"7 1.5 0 0 0 0 0 0 1\n", "frame number"},
                                            {"1,0,0,0,1,0,0,0,0,0,0,0,0,0,0,0,0\n", "EuRoC"},
                                            {"2012-07-09T15:07:14 0 0 0 0 0 0 1\n", "date"}}) {
    EXPECT_TRUE(mentions(
        messageOf<std::runtime_error>([&] { evaluate::parseTrajectory(kind.line, "poses.txt"); }),
        {"poses.txt:1: ", kind.said}));
  }
}

/// Camera poses on an arc, turning about two axes; `change` as another program would write them.
evaluate::Trajectory arc(const std::function<Eigen::Isometry3d(const Eigen::Isometry3d&)>& change) {
  evaluate::Trajectory poses;
  for (int i = 0; i < 40; ++i) {
    const double angle = 0.03 * i;
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = (Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()) *
                     Eigen::AngleAxisd(1.0 + 0.5 * angle, Eigen::Vector3d::UnitX()))
                        .toRotationMatrix();
    pose.translation() = Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.1 * angle);
    evaluate::StampedPose stamped;
    stamped.timestamp = 0.1 * i;
    stamped.pose = change(pose);
    poses.push_back(stamped);
  }
  return poses;
}

TEST_F(Dialects, ConventionsThatNormAndFormatDoNotShowAreTold) {
  const auto as_it_is = [](const Eigen::Isometry3d& pose) { return pose; };
  const auto w_first = [](const Eigen::Isometry3d& pose) {
    const Eigen::Quaterniond q(pose.linear());
    Eigen::Isometry3d other = pose;  // w x y z in the columns of x y z w
    other.linear() = Eigen::Quaterniond(q.z(), q.w(), q.x(), q.y()).toRotationMatrix();
    return other;
  };
  const auto inverted = [](const Eigen::Isometry3d& pose) { return pose.inverse(); };
  const auto in_mm = [](const Eigen::Isometry3d& pose) {
    Eigen::Isometry3d other = pose;
    other.translation() *= 1000.0;
    return other;
  };
  const auto in_another_world = [](const Eigen::Isometry3d& pose) {
    Eigen::Isometry3d world = Eigen::Isometry3d::Identity();
    world.linear() = Eigen::AngleAxisd(2.0, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    world.translation() = Eigen::Vector3d(5.0, -3.0, 1.0);
    return world * pose;
  };
  const evaluate::Trajectory truth = arc(as_it_is);
  EXPECT_EQ(evaluate::otherConvention(truth, truth), "");
  EXPECT_EQ(evaluate::otherConvention(truth, arc(in_another_world)), "");
  EXPECT_TRUE(
      mentions(evaluate::otherConvention(truth, arc(w_first)), {"the estimate's", "w came first"}));
  EXPECT_TRUE(mentions(evaluate::otherConvention(arc(w_first), truth),
                       {"the ground truth's", "w came first"}));
  EXPECT_TRUE(
      mentions(evaluate::otherConvention(truth, arc(inverted)), {"the estimate's", "inverted"}));
  EXPECT_TRUE(
      mentions(evaluate::otherConvention(truth, arc(in_mm)), {"the estimate's", "millimetres"}));
  EXPECT_TRUE(mentions(evaluate::otherConvention(arc(in_mm), truth),
                       {"the ground truth's", "millimetres"}));
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
  using namespace std::string_literals;
  for (const auto& [start, kind] :
       {std::pair("\x1F\x8B\x08\x00"s, "gzip"), std::pair("\x89PNG\r\n"s, "PNG"),
        std::pair("PK\x03\x04\x00"s, "PyTorch"), std::pair("\x80\x02}q"s, "pickle"),
        std::pair("#ROSBAG V2.0\n"s, "bag of ROS")}) {
    EXPECT_TRUE(mentions(
        messageOf<std::runtime_error>([&, &bytes = start] { support::toText(bytes, "list.txt"); }),
        {"list.txt: expected text", kind}));
  }
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

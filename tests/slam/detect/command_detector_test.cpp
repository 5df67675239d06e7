// SPDX-License-Identifier: BSD-3-Clause
// A program of the user's as a detector: what it may answer, and all that it may do wrong.
#include "slam/detect/command_detector.hpp"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <fstream>
#include <stdexcept>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <sys/types.h>

#include "input/dataset/temporary_folder.hpp"
#include "shared_data.hpp"

namespace hmcdyn::slam {
namespace {

using hmcdyn::test::mentions;
using hmcdyn::test::messageOf;
using hmcdyn::test::TemporaryFolder;

constexpr const char* kHello = R"(echo '{"hmcdyn_detector": 1, "version": "toy 2"}'; )";
// Image by image: the header line, and then its bytes; an image here has 12.
constexpr const char* kEachImage = "while read -r header; do head -c 12 >/dev/null; ";

DetectorOptions running(const std::string& command) {
  DetectorOptions options;
  options.type = "command";
  options.command.line = command;
  return options;
}

/// Answers each image in turn with `answer`, in which $n is the image's number.
std::string answering(const std::string& answer) {
  return std::string(kHello) + "n=0; " + kEachImage + "n=$((n + 1)); " + answer + "; done";
}

cv::Mat image() { return cv::Mat::zeros(2, 2, CV_8UC3); }

std::string failure(ObjectDetector& detector) {
  return messageOf<std::runtime_error>([&] { detector.see(image(), 1.5); });
}

std::string failureToStart(const std::string& command) {
  return messageOf<std::runtime_error>([&] { makeCommandDetector(running(command)); });
}

TEST(CommandDetector, GivesTheBoxesOfEachImageAndItsVersion) {
  const auto detector = makeCommandDetector(running(answering(
      R"(echo "{\"frame\": $n, \"boxes\": [[0, 0.5, 1, 1, 0.9, \"person\"], [0, 0, 1, 1, 0.1, 0]]}")")));
  for (int i = 0; i < 3; ++i) {
    const std::vector<DetectionBox> boxes = detector->detect(image(), 0.1 * i);
    ASSERT_EQ(boxes.size(), 1U);  // the other's score is below the threshold
    EXPECT_FLOAT_EQ(boxes[0].y_min, 0.5f);
    EXPECT_EQ(boxes[0].class_id, kPersonClassId);
  }
  EXPECT_TRUE(mentions(detector->name(), {"toy 2"}));
}

TEST(CommandDetector, TellsTheImageItsStampAndItsSize) {
  const TemporaryFolder folder;
  const std::string seen = (folder.path() / "seen").string();
  const auto detector = makeCommandDetector(
      running(std::string(kHello) + "read -r header; echo \"$header\" >" + seen +
              "; head -c 12 >>" + seen + R"(; echo '{"frame": 1, "boxes": []}')"));
  cv::Mat bgr(2, 2, CV_8UC3);
  for (int i = 0; i < 12; ++i) {
    bgr.data[i] = static_cast<unsigned char>('a' + i);
  }
  EXPECT_TRUE(detector->detect(bgr, 1341846434.710184).empty());
  std::ifstream file(seen);
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  EXPECT_EQ(text,
            "{\"frame\": 1, \"timestamp\": 1341846434.710184, \"width\": 2, \"height\": 2, "
            "\"bytes\": 12}\nabcdefghijkl");
}

TEST(CommandDetector, NeedsACommand) {
  EXPECT_TRUE(mentions(messageOf<std::invalid_argument>([] { makeCommandDetector(running("")); }),
                       {"--command is not given"}));
}

TEST(CommandDetector, ACommandThatIsNotThereIsNamedWithTheShellsWords) {
  EXPECT_TRUE(
      mentions(failureToStart("no_such_detector --fast"),
               {"no_such_detector --fast", "exit code 127", "no such command", "not found"}));
}

TEST(CommandDetector, OneThatDiesBeforeItsFirstLineIsQuoted) {
  EXPECT_TRUE(mentions(failureToStart("echo 'no GPU' >&2; exit 3"), {"exit code 3", "no GPU"}));
}

TEST(CommandDetector, AnotherFirstLineIsRefused) {
  EXPECT_TRUE(mentions(failureToStart("echo loading; cat"), {"'loading'", "hmcdyn_detector"}));
  EXPECT_TRUE(mentions(failureToStart(R"(echo '{"hmcdyn_detector": 2}'; cat)"),
                       {"expected \"hmcdyn_detector\": 1"}));
}

TEST(CommandDetector, OneThatIsKilledIsStartedAgain) {
  const TemporaryFolder folder;
  const std::string been = (folder.path() / "been").string();
  // The first process kills itself at its first image; the second answers.
  const auto detector = makeCommandDetector(
      running(std::string(kHello) + kEachImage + "if [ ! -e " + been + " ]; then : >" + been +
              R"(; kill -9 $$; fi; echo '{"frame": 2, "boxes": []}'; done)"));
  EXPECT_TRUE(mentions(failure(*detector), {"signal 9"}));
  EXPECT_TRUE(detector->detect(image(), 2.0).empty());
}

TEST(CommandDetector, OneThatIsKilledUnderItsShellNamesTheSignalToo) {
  const auto detector = makeCommandDetector(
      running(std::string(kHello) + "read -r header; sh -c 'kill -9 $$'; exit $?"));
  EXPECT_TRUE(mentions(failure(*detector), {"exit code 137", "signal 9, Killed"}));
}

TEST(CommandDetector, OneThatAlwaysDiesIsGivenUp) {
  DetectorOptions options = running(std::string(kHello) + "read -r header; exit 4");
  options.command.restarts = 2;
  const auto detector = makeCommandDetector(options);
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(mentions(failure(*detector), {"exit code 4"}));
  }
  EXPECT_TRUE(mentions(failure(*detector), {"started 2 times again", "given up"}));
}

/// True as soon as the process is killed: gone, or not yet collected by the system's first process.
/// The kernel ends it some moments after the signal was sent.
bool ends(pid_t pid) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point last = Clock::now() + std::chrono::seconds(20);
  while (Clock::now() < last) {
    std::ifstream status("/proc/" + std::to_string(pid) + "/stat");
    std::string text;
    std::getline(status, text);
    if (text.empty() || text.find(") Z") != std::string::npos) {
      return true;
    }
    std::this_thread::yield();
  }
  return false;
}

TEST(CommandDetector, OneThatHangsIsKilledAtTheTimeOutWithAllItStarted) {
  const TemporaryFolder folder;
  const std::string number = (folder.path() / "pid").string();
  DetectorOptions options =
      running(std::string(kHello) + "sleep 1000 & echo $! >" + number + "; wait");
  options.command.timeout = 2.0;  // (s): a slow machine has started both by then
  const auto detector = makeCommandDetector(options);
  EXPECT_TRUE(mentions(failure(*detector), {"in time"}));
  pid_t pid = 0;
  std::ifstream(number) >> pid;
  ASSERT_GT(pid, 0);
  EXPECT_TRUE(ends(pid)) << pid;
}

TEST(CommandDetector, GarbageIsQuoted) {
  const auto detector = makeCommandDetector(running(answering("echo 'person at 1 2 3'")));
  EXPECT_TRUE(mentions(failure(*detector), {"'person at 1 2 3'", "JSON"}));
}

TEST(CommandDetector, ALineWithoutAnEndIsNoAnswer) {
  DetectorOptions options = running(answering("head -c 20000000 /dev/zero | tr '\\0' x"));
  const auto detector = makeCommandDetector(options);
  EXPECT_TRUE(mentions(failure(*detector), {"without the end of a line"}));
}

TEST(CommandDetector, AnAnswerForAnotherFrameIsRefused) {
  const auto detector =
      makeCommandDetector(running(answering(R"(echo '{"frame": 9, "boxes": []}')")));
  EXPECT_TRUE(mentions(failure(*detector), {"expected an answer to frame 1"}));
}

TEST(CommandDetector, WhatFloodsItsStandardErrorAnswersAllTheSame) {
  // Far more than a pipe holds.
  const auto detector = makeCommandDetector(running(answering(
      R"(head -c 1000000 /dev/zero | tr '\0' e >&2; echo "{\"frame\": $n, \"boxes\": []}")")));
  EXPECT_TRUE(detector->detect(image(), 1.0).empty());
  EXPECT_TRUE(detector->detect(image(), 2.0).empty());
}

TEST(CommandDetector, WhatFloodsItsStandardErrorAndDoesNotAnswerIsKilledAtTheTimeOut) {
  DetectorOptions options =
      running(std::string(kHello) + "read -r header; while :; do echo working >&2; done");
  options.command.timeout = 2.0;
  const auto detector = makeCommandDetector(options);
  EXPECT_TRUE(mentions(failure(*detector), {"in time", "working"}));
}

TEST(CommandDetector, ItsOwnErrorIsPassedOn) {
  const auto detector =
      makeCommandDetector(running(answering(R"(echo '{"error": "out of memory"}')")));
  EXPECT_TRUE(mentions(failure(*detector), {"out of memory"}));
}

TEST(CommandDetector, AMaskThatIsMissingOrOfAnotherSizeIsNamed) {
  const auto missing =
      makeCommandDetector(running(answering(R"(echo '{"frame": 1, "mask": "/no/mask.png"}')")));
  EXPECT_TRUE(mentions(failure(*missing), {"/no/mask.png"}));
  const auto damaged = makeCommandDetector(
      running(answering(R"(echo '{"frame": 1, "mask_bytes": 3}'; printf abc)")));
  EXPECT_TRUE(mentions(failure(*damaged), {"mask of 3 bytes", "no image", "2 x 2 px"}));
}

TEST(CommandAnswer, WhatIsNoBoxIsQuoted) {
  const auto refusal = [](const std::string& line) {
    return messageOf<std::runtime_error>([&] { parseCommandAnswer(line, 1); });
  };
  EXPECT_TRUE(
      mentions(refusal(R"({"frame": 1, "boxes": [[1, 2, 3, 4]]})"), {"[1,2,3,4]", "score"}));
  EXPECT_TRUE(mentions(refusal(R"({"frame": 1, "boxes": [[1, 2, 3, 4, 90, 0]]})"), {"score 0..1"}));
  EXPECT_TRUE(mentions(refusal(R"({"frame": 1, "boxes": [[1, 2, 3, 4, 0.9, "elf"]]})"), {"elf"}));
  EXPECT_TRUE(mentions(refusal(R"({"frame": 1})"), {"\"boxes\", \"mask\""}));
  EXPECT_TRUE(mentions(refusal(R"({"frame": 1, "mask_bytes": -3})"), {"mask_bytes"}));
}

}  // namespace
}  // namespace hmcdyn::slam

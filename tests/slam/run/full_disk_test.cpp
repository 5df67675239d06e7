// SPDX-License-Identifier: BSD-3-Clause
// A disk that fills while hmcdyn_slam writes: it says so, exits with 1, and keeps what it had.
#include <algorithm>
#include <filesystem>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "file_content.hpp"
#include "input/dataset/temporary_folder.hpp"
#include "run/shell.hpp"
#include "run/toy_sequence.hpp"

namespace hmcdyn::slam {
namespace {

using hmcdyn::test::contentOf;
using test::Outcome;
using test::runShell;

class FullDisk : public testing::Test {
 protected:
  FullDisk() {
    test::ToySequence toy;
    toy.frames = kFrames;
    test::writeToySequence(folder_.path() / "toy", toy);
    std::filesystem::create_directories(folder_.path() / "disk");
    std::filesystem::create_directories(folder_.path() / "kept");
  }

  /// keypoints.csv has some 60 kB a frame.
  std::string slam(const std::string& output) const {
    const std::string toy = (folder_.path() / "toy").string();
    return fmt::format(
        "{} --dataset {} --camera {}/calibration.yaml --output {} --quiet --write-keypoints",
        HMCDYN_SLAM, toy, toy, output);
  }

  /// What must be there after a run that could not go on: its first frames, and why it ended.
  static void expectBeginning(const std::filesystem::path& results, const std::string& reason) {
    const nlohmann::json summary = nlohmann::json::parse(contentOf(results / "summary.json"));
    const nlohmann::json& counts = summary.at("counts");
    const int tracked = counts.at("frames_tracked").get<int>();
    EXPECT_GE(tracked, 3);
    EXPECT_LT(tracked, kFrames);
    EXPECT_EQ(counts.at("frames_in"), tracked);
    ASSERT_FALSE(counts.at("write_failures").empty());
    EXPECT_TRUE(hmcdyn::test::mentions(counts.at("write_failures").front().get<std::string>(),
                                       {"keypoints.csv", reason}));
    const std::string trajectory = contentOf(results / "trajectory.txt");
    EXPECT_EQ(std::count(trajectory.begin(), trajectory.end(), '\n'), tracked);
    const std::string points = contentOf(results / "keypoints.csv");
    ASSERT_FALSE(points.empty());
    EXPECT_EQ(points.back(), '\n') << "a row was cut";
    EXPECT_FALSE(std::filesystem::exists(results / "trajectory.txt.tmp"));
  }

  static constexpr int kFrames = 40;
  hmcdyn::test::TemporaryFolder folder_;
};

TEST_F(FullDisk, AFileThatMayNotGrowEndsTheRunWithAMessage) {
  // The limit on a file's size fails write() in the middle, as a full disk does. 1200 KiB: more
  // than the reserve, less than keypoints.csv would have.
  const std::filesystem::path results = folder_.path() / "kept";
  const Outcome outcome = runShell("trap '' XFSZ; ulimit -f 2400; " + slam(results.string()));
  EXPECT_EQ(outcome.exit_code, 1) << outcome.text;
  EXPECT_TRUE(hmcdyn::test::mentions(outcome.text, {"keypoints.csv", "File too large"}));
  expectBeginning(results, "File too large");
}

TEST_F(FullDisk, ADiskThatFillsEndsTheRunAndTheReserveHoldsTheSummary) {
  const std::string disk = (folder_.path() / "disk").string();
  const std::string mounted = fmt::format(
      "unshare --user --map-root-user --mount sh -c 'mount -t tmpfs -o size=2m tmpfs {}", disk);
  if (runShell(mounted + "'").exit_code != 0) {
    GTEST_SKIP() << "cannot mount a tmpfs here (unshare --user --map-root-user --mount)";
  }
  const Outcome outcome =
      runShell(fmt::format("{} && {}; code=$?; cp -r {}/out/. {}; exit $code'", mounted,
                           slam(disk + "/out"), disk, (folder_.path() / "kept").string()));
  EXPECT_EQ(outcome.exit_code, 1) << outcome.text;
  EXPECT_TRUE(hmcdyn::test::mentions(outcome.text, {"keypoints.csv", "No space left on device"}));
  expectBeginning(folder_.path() / "kept", "No space left on device");
}

TEST_F(FullDisk, ADiskWithoutRoomForTheReserveIsRefusedBeforeAnyWork) {
  const std::filesystem::path results = folder_.path() / "kept";
  const Outcome outcome = runShell("trap '' XFSZ; ulimit -f 8; " + slam(results.string()));
  EXPECT_EQ(outcome.exit_code, 1) << outcome.text;
  EXPECT_TRUE(hmcdyn::test::mentions(outcome.text, {"output folder", "cannot be written"}));
  EXPECT_FALSE(std::filesystem::exists(results / "summary.json"));
  EXPECT_FALSE(std::filesystem::exists(results / ".reserve"));
}

}  // namespace
}  // namespace hmcdyn::slam

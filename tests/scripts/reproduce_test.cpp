// SPDX-License-Identifier: BSD-3-Clause
// scripts/reproduce.sh with a stand-in for hmcdyn_slam: what is run, what is not run again, what is
// said of failures. The script is copied beside binaries of the test's own.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include "evaluate/temporary_folder.hpp"

namespace hmcdyn {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

int shell(const std::string& command) {
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

struct ProcessResult {
  int exit_code = -1;
  std::string text;  ///< Both streams.
};

/// Writes down its arguments, and a summary, unless the file `fail` names its ablation.
constexpr const char* kStandIn = R"(#!/usr/bin/env bash
root=$(dirname "$0")/../../..
echo "$*" >>"$root/calls"
while (($# > 0)); do
  case "$1" in
    --output) output=$2 ;;
    --ablation) ablation=$2 ;;
  esac
  shift
done
if [[ -f $root/fail && $(<"$root/fail") == "${ablation-}" ]]; then
  echo '{"counts": {' >"$output/summary.json"
  exit 1
fi
cat >"$output/summary.json" <<JSON
{"counts": {"frames_in": 10, "frames_tracked": 9, "stopped_by_signal": false}, "tracking_cpu_ms": 5,
 "evaluation": {"ate_m": {"rmse": 0.02, "std": 0.01}}}
JSON
)";

class Reproduce : public evaluate::test::TemporaryFolder {
 protected:
  void SetUp() override {
    if (shell("command -v flock > /dev/null && command -v xargs > /dev/null") != 0) {
      GTEST_SKIP() << "flock or xargs is not installed";
    }
    fs::create_directories(path("scripts"));
    fs::create_directories(path("build/ci/bin"));
    for (const char* file : {"reproduce.sh", "paper_tables.csv"}) {
      fs::copy(fs::path(HMCDYN_SCRIPTS) / file, path("scripts"));
    }
    fs::copy(HMCDYN_TABLES, path("build/ci/bin"));
    write("build/ci/bin/hmcdyn_slam", kStandIn);
    fs::permissions(path("build/ci/bin/hmcdyn_slam"), fs::perms::owner_all);
    addSequence("rgbd_dataset_freiburg3_walking_xyz");
  }

  void addSequence(const std::string& name) const {
    fs::create_directories(path("data/" + name));
    for (const char* file : {"rgb.txt", "depth.txt", "boxes.txt"}) {
      write("data/" + name + "/" + file, "");
    }
  }

  ProcessResult reproduce(const std::string& arguments) const {
    const int code = shell("cd '" + path("").string() + "' && scripts/reproduce.sh --preset ci " +
                           arguments + " > log 2>&1");
    return {code, read(path("log"))};
  }

  /// The calls of hmcdyn_slam since the last time.
  std::string takeCalls() const {
    std::string calls = read(path("calls"));
    fs::remove(path("calls"));
    return calls;
  }
};

std::size_t linesOf(const std::string& text) {
  std::size_t lines = 0;
  for (const char c : text) {
    lines += c == '\n' ? 1 : 0;
  }
  return lines;
}

TEST_F(Reproduce, RunsEveryVariantAndSeedAndWritesTheTables) {
  addSequence("rgbd_bonn_crowd");
  const ProcessResult result = reproduce("--datasets data --runs 2 --jobs 2 --output out");
  ASSERT_EQ(result.exit_code, 0) << result.text;
  const std::string calls = takeCalls();
  EXPECT_EQ(linesOf(calls), 2U * 9U * 2U);
  EXPECT_THAT(calls, HasSubstr("rgbd_bonn_crowd --camera bonn --detector file --boxes"));
  EXPECT_THAT(calls, HasSubstr("walking_xyz --camera tum3"));
  EXPECT_THAT(calls, HasSubstr("--filter hmc --ablation rs --seed 2"));
  EXPECT_THAT(calls, HasSubstr("--filter hmc --ablation opw --seed 1"));
  EXPECT_THAT(result.text, HasSubstr("[36/36]"));
  EXPECT_THAT(result.text, HasSubstr("left"));
  const std::string page = read(path("out/tables/tables.md"));
  EXPECT_THAT(page, HasSubstr("# Results of 36 runs"));
  EXPECT_THAT(page, HasSubstr("| 0.0200 (0.0200-0.0200) | 0.0152 |"));
  EXPECT_THAT(page, Not(HasSubstr("not comparable")));
  EXPECT_TRUE(fs::exists(path("out/tables/table_6.csv")));
}

TEST_F(Reproduce, WhatIsDoneIsNotDoneAgain) {
  const std::string call = "--datasets data --variants hmc,none --output out --runs ";
  ASSERT_EQ(reproduce(call + "1").exit_code, 0);
  EXPECT_EQ(linesOf(takeCalls()), 2U);
  ASSERT_EQ(reproduce(call + "1").exit_code, 0);
  EXPECT_EQ(takeCalls(), "");
  // A summary that a kill cut off, and one more seed
  write("out/runs/rgbd_dataset_freiburg3_walking_xyz/none/seed1/summary.json", "{\"counts\": ");
  const ProcessResult result = reproduce(call + "2");
  ASSERT_EQ(result.exit_code, 0) << result.text;
  EXPECT_THAT(result.text, HasSubstr("4 in all, 1 done already"));
  const std::string calls = takeCalls();
  EXPECT_EQ(linesOf(calls), 3U);
  EXPECT_THAT(calls, HasSubstr("--filter none --seed 1"));
}

TEST_F(Reproduce, AFailedRunIsNamedAndTriedAgain) {
  write("fail", "rs");
  const std::string call = "--datasets data --variants hmc,rs --runs 1 --output out";
  const ProcessResult failed = reproduce(call);
  EXPECT_EQ(failed.exit_code, 1);
  EXPECT_THAT(failed.text, HasSubstr("rs seed 1: FAILED, exit code 1"));
  EXPECT_THAT(failed.text, HasSubstr("1 of 2 runs failed"));
  EXPECT_THAT(read(path("out/tables/tables.md")), HasSubstr("**1 runs are not in these tables:**"));
  fs::remove(path("fail"));
  takeCalls();
  EXPECT_EQ(reproduce(call).exit_code, 0);
  EXPECT_EQ(linesOf(takeCalls()), 1U);
}

TEST_F(Reproduce, RunsWithOtherOptionsDoNotStandInOneTable) {
  const std::string call = "--datasets data --variants hmc --runs 1 --output out";
  ASSERT_EQ(reproduce(call + " -- --max-frames 7").exit_code, 0);
  const ProcessResult other = reproduce(call);
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_THAT(other.text, HasSubstr("other options of hmcdyn_slam: --max-frames 7;"));
  EXPECT_EQ(reproduce(call + " -- --max-frames 7").exit_code, 0);
}

TEST_F(Reproduce, WhatFollowsTheDashesGoesToEveryRun) {
  fs::remove(path("data/rgbd_dataset_freiburg3_walking_xyz/boxes.txt"));
  const std::string call = "--datasets data --variants hmc --runs 1 --output out";
  const ProcessResult none = reproduce(call);
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_THAT(none.text, HasSubstr("no boxes.txt; name a detector after --"));
  EXPECT_EQ(reproduce(call + " -- --detector hog --max-frames 7").exit_code, 0);
  const std::string calls = takeCalls();
  EXPECT_THAT(calls, HasSubstr("--detector hog --max-frames 7"));
  EXPECT_THAT(calls, Not(HasSubstr("--boxes")));
}

TEST_F(Reproduce, RenderedScenesAreMarkedAsSuch) {
  addSequence("walking_xyz");
  write("data/walking_xyz/associations.txt", "");
  write("data/walking_xyz/calibration.yaml", "");
  const ProcessResult result = reproduce(
      "--rendered --sequences data --scenes walking_xyz --variants hmc --runs 1 --output out");
  ASSERT_EQ(result.exit_code, 0) << result.text;
  EXPECT_THAT(takeCalls(), HasSubstr("data/walking_xyz/calibration.yaml"));
  EXPECT_THAT(read(path("out/tables/tables.md")), HasSubstr("not comparable"));
}

TEST_F(Reproduce, WhatIsMissingIsNamed) {
  fs::create_directories(path("empty"));
  EXPECT_THAT(reproduce("--datasets empty --output out").text, HasSubstr("no sequence"));
  addSequence("of_my_own");
  EXPECT_THAT(reproduce("--datasets data --output out").text,
              HasSubstr("of_my_own: which camera?"));
  fs::remove(path("build/ci/bin/hmcdyn_slam"));
  const ProcessResult unbuilt = reproduce("--datasets data --output out");
  EXPECT_EQ(unbuilt.exit_code, 1);
  EXPECT_THAT(unbuilt.text, HasSubstr("hmcdyn_slam is missing; build it"));
}

TEST_F(Reproduce, WrongUsageIsExitCodeTwo) {
  for (const char* arguments :
       {"", "--datasets missing", "--datasets data --rendered", "--datasets data --runs 0",
        "--datasets data --jobs many", "--datasets data --variants unknown", "--bogus", "--runs"}) {
    EXPECT_EQ(reproduce(arguments).exit_code, 2) << arguments;
  }
  EXPECT_EQ(reproduce("--help").exit_code, 0);
}

}  // namespace
}  // namespace hmcdyn

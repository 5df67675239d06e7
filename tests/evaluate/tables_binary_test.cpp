// SPDX-License-Identifier: BSD-3-Clause
// hmcdyn_tables, run as a user runs it.
#include <cstdlib>
#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include "temporary_folder.hpp"

namespace hmcdyn::evaluate {
namespace {

using testing::HasSubstr;
using testing::Not;

struct ProcessResult {
  int exit_code = -1;
  std::string output;
  std::string errors;
};

class TablesBinary : public test::TemporaryFolder {
 protected:
  ProcessResult run(const std::string& arguments) const {
    const std::string command = "cd '" + path("").string() + "' && " HMCDYN_TABLES " " + arguments +
                                " > stdout.txt 2> stderr.txt";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read(path("stdout.txt")),
            read(path("stderr.txt"))};
  }
  ProcessResult tables(const std::string& more = "") const {
    return run("--runs runs --paper " HMCDYN_SCRIPTS "/paper_tables.csv --output tables " + more);
  }
  void addRun(const std::string& folder, double ate) const {
    std::filesystem::create_directories(path("runs/" + folder));
    write("runs/" + folder + "/summary.json",
          R"({"counts": {"frames_in": 100, "frames_tracked": 90, "stopped_by_signal": false},
              "tracking_cpu_ms": 12.5, "evaluation": {"ate_m": {"std": 0.001, "rmse": )" +
              std::to_string(ate) + "}}}");
  }
};

TEST_F(TablesBinary, WritesMarkdownAndCsv) {
  addRun("walking_xyz/hmc/seed1", 0.01);
  addRun("walking_xyz/hmc/seed2", 0.02);
  addRun("walking_xyz/none/seed1", 0.10);
  const ProcessResult result = tables("--rendered");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const std::string page = read(path("tables/tables.md"));
  EXPECT_EQ(page, result.output);
  EXPECT_THAT(page, HasSubstr("0.0150 (0.0100-0.0200) | 0.0152"));
  EXPECT_THAT(page, HasSubstr("| walking_xyz | 85.0 | 96.0 |"));  // 1 - 0.0152 / 0.3781
  EXPECT_THAT(page, HasSubstr("not comparable"));
  EXPECT_THAT(page, Not(HasSubstr("runs are not in these tables")));
  for (const char* name : {"table_1", "table_2", "table_3", "table_4", "table_5", "table_6"}) {
    EXPECT_THAT(read(path("tables/" + std::string(name) + ".csv")), HasSubstr("hmc")) << name;
  }
  EXPECT_THAT(read(path("tables/improvement.csv")), HasSubstr("walking_xyz,85.0,96.0\n"));
}

TEST_F(TablesBinary, SaysWhichRunsAreLeftOut) {
  addRun("crowd/hmc/seed1", 0.01);
  std::filesystem::create_directories(path("runs/crowd/hmc/seed2"));
  const ProcessResult result = tables();
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.errors, HasSubstr("crowd/hmc/seed2/summary.json: cannot be read"));
  EXPECT_THAT(result.output, HasSubstr("**1 runs are not in these tables:**"));
}

TEST_F(TablesBinary, ChecksASummary) {
  addRun("crowd/hmc/seed1", 0.01);
  EXPECT_EQ(run("--check runs/crowd/hmc/seed1/summary.json").exit_code, 0);
  write("cut.json", "{\"counts\": ");
  EXPECT_EQ(run("--check cut.json").exit_code, 1);
  const ProcessResult missing = run("--check missing.json");
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_THAT(missing.errors, HasSubstr("missing.json: cannot be read"));
}

TEST_F(TablesBinary, NamesWhatIsMissing) {
  EXPECT_THAT(tables().errors, HasSubstr("runs: is no folder"));
  std::filesystem::create_directories(path("runs"));
  const ProcessResult empty = tables();
  EXPECT_EQ(empty.exit_code, 1);
  EXPECT_THAT(empty.errors, HasSubstr("runs: no finished run"));
  addRun("crowd/hmc/seed1", 0.01);
  const ProcessResult no_paper = run("--runs runs --paper missing.csv --output tables");
  EXPECT_EQ(no_paper.exit_code, 1);
  EXPECT_THAT(no_paper.errors, HasSubstr("missing.csv: cannot be read"));
}

TEST_F(TablesBinary, WrongUsageIsExitCodeTwo) {
  EXPECT_EQ(run("").exit_code, 2);
  EXPECT_EQ(run("--runs runs").exit_code, 2);
  EXPECT_EQ(run("--unknown").exit_code, 2);
  EXPECT_EQ(run("--help").exit_code, 0);
}

}  // namespace
}  // namespace hmcdyn::evaluate

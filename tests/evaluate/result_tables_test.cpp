// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/result_tables.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hmcdyn::evaluate {
namespace {

using testing::HasSubstr;

RunSummary runOf(const std::string& sequence, const std::string& variant, double ate,
                 std::size_t tracked = 100, double ms = 10.0) {
  RunSummary run;
  run.sequence = sequence;
  run.variant = variant;
  run.frames = 100;
  run.tracked = tracked;
  run.tracking_ms = ms;
  run.ate = ErrorSummary{ate, ate / 2.0};
  return run;
}

const ResultTable& find(const std::vector<ResultTable>& tables, const std::string& name) {
  const auto found = std::find_if(tables.begin(), tables.end(),
                                  [&](const ResultTable& table) { return table.name == name; });
  if (found == tables.end()) {
    throw std::runtime_error("no table " + name);
  }
  return *found;
}

/// The cell of a row under a heading.
std::string cell(const ResultTable& table, const std::string& row, const std::string& column) {
  const auto heading = std::find(table.header.begin(), table.header.end(), column);
  for (const std::vector<std::string>& cells : table.rows) {
    if (cells.at(0) == row && heading != table.header.end()) {
      return cells.at(static_cast<std::size_t>(heading - table.header.begin()));
    }
  }
  return "no such cell";
}

const std::string kWalking = "rgbd_dataset_freiburg3_walking_xyz";

TEST(ResultTables, ShowMeanLowestAndHighestBesideThePapersFigure) {
  // Given three runs of 0.01, 0.02 and 0.06 m: mean 0.03
  const std::vector<RunSummary> runs{runOf(kWalking, "hmc", 0.01), runOf(kWalking, "hmc", 0.06),
                                     runOf(kWalking, "hmc", 0.02), runOf(kWalking, "rs", 0.05)};
  const std::vector<PaperValue> paper{{"I", "WALKXYZ", "HMC", "ate_rmse", 0.0152},
                                      {"I", "WALKXYZ", "RS", "ate_sd", 0.0088},
                                      {"III", "WALKXYZ", "HMC", "ate_rmse", 0.9}};
  const std::vector<ResultTable> tables = makeTables(runs, paper, false);
  const ResultTable& table = find(tables, "table_1");
  EXPECT_EQ(cell(table, kWalking, "hmc RMSE"), "0.0300 (0.0100-0.0600)");
  EXPECT_EQ(cell(table, kWalking, "hmc S.D."), "0.0150 (0.0050-0.0300)");
  EXPECT_EQ(cell(table, kWalking, "paper: HMC RMSE"), "0.0152");
  EXPECT_EQ(cell(table, kWalking, "RS RMSE"), "0.0500");
  EXPECT_EQ(cell(table, kWalking, "paper: RS S.D."), "0.0088");
  EXPECT_EQ(cell(table, kWalking, "runs"), "0-3");  // none of DF and OPW
}

TEST(ResultTables, WhatWasNotMeasuredIsADash) {
  RunSummary without_truth = runOf("office", "hmc", 0.0);
  without_truth.ate.reset();
  const std::vector<ResultTable> tables =
      makeTables({without_truth, runOf(kWalking, "none", 0.1)}, {}, false);
  for (const char* name : {"table_1", "table_3"}) {
    EXPECT_EQ(cell(find(tables, name), "office", "hmc RMSE"), "-");
    EXPECT_EQ(cell(find(tables, name), "office", "paper: HMC RMSE"), "-");
  }
  EXPECT_EQ(cell(find(tables, "table_4"), kWalking, "none RMSE"), "-");  // no RPE
  EXPECT_EQ(cell(find(tables, "improvement"), kWalking, "ours (%)"), "-");
}

TEST(ResultTables, TheTrackingRateIsEquation11) {
  const std::vector<ResultTable> tables = makeTables(
      {runOf("crowd", "rs", 0.1, 58), runOf("crowd", "rs", 0.1, 60), runOf("crowd", "hmc", 0.1)},
      {{"II", "CROWD", "RS", "tracking_rate", 88.1}, {"II", "CROWD", "RS", "time_ms", 2.71}},
      false);
  const ResultTable& table = find(tables, "table_2");
  EXPECT_EQ(cell(table, "crowd", "RS tracking rate (%)"), "59.0 (58.0-60.0)");
  EXPECT_EQ(cell(table, "crowd", "paper: RS tracking rate (%)"), "88.1");
  EXPECT_EQ(cell(table, "crowd", "hmc tracking rate (%)"), "100.0");
  EXPECT_EQ(cell(table, "crowd", "hmc tracking (ms CPU)"), "10.00");
  // The paper's module times are not set against whole tracking times.
  EXPECT_EQ(std::count_if(table.header.begin(), table.header.end(),
                          [](const std::string& text) {
                            return text.find("paper") != std::string::npos &&
                                   text.find("ms") != std::string::npos;
                          }),
            0);
}

TEST(ResultTables, TheImprovementIsEquation12) {
  // Given means of 0.2 and 0.03 m: 85 %; and one sequence that got worse, by 50 %
  const std::vector<RunSummary> runs{runOf(kWalking, "none", 0.1), runOf(kWalking, "none", 0.3),
                                     runOf(kWalking, "hmc", 0.03), runOf("empty", "none", 0.02),
                                     runOf("empty", "hmc", 0.03)};
  const std::vector<PaperValue> paper{{"III", "WALKXYZ", "ORB-SLAM3", "ate_rmse", 0.4},
                                      {"III", "WALKXYZ", "HMC", "ate_rmse", 0.1}};
  const std::vector<ResultTable> tables = makeTables(runs, paper, false);
  const ResultTable& table = find(tables, "improvement");
  EXPECT_EQ(cell(table, kWalking, "ours (%)"), "85.0");
  EXPECT_EQ(cell(table, "empty", "ours (%)"), "-50.0");
  EXPECT_EQ(cell(table, "mean", "ours (%)"), "17.5");
  EXPECT_EQ(cell(table, kWalking, "paper: over ORB-SLAM3 (%)"), "75.0");
  EXPECT_EQ(cell(table, "empty", "paper: over ORB-SLAM3 (%)"), "-");
}

TEST(ResultTables, TimeIsTheMeanOfTheSequencesMeans) {
  // Given 10 and 20 ms on one sequence, 30 ms on another: 15 and 30
  const std::vector<ResultTable> tables =
      makeTables({runOf("a", "hmc", 0.1, 100, 10.0), runOf("a", "hmc", 0.1, 100, 20.0),
                  runOf("b", "hmc", 0.1, 100, 30.0)},
                 {{"VI", "mean", "HMC", "time_ms", 51.02}}, false);
  const ResultTable& table = find(tables, "table_6");
  EXPECT_EQ(cell(table, "hmc", "ours (ms)"), "22.50 (15.00-30.00)");
  EXPECT_EQ(cell(table, "hmc", "paper (ms)"), "51.02");
  EXPECT_EQ(cell(table, "none", "ours (ms)"), "-");
}

TEST(ResultTables, PeersTablesHaveTheirOwnErrors) {
  RunSummary run = runOf(kWalking, "chi2", 0.1);
  run.translation = ErrorSummary{0.02, 0.01};
  run.rotation = ErrorSummary{0.6, 0.3};
  const std::vector<ResultTable> tables =
      makeTables({run},
                 {{"IV", "WALKXYZ", "OVD-SLAM", "rpe_translation_rmse", 0.0207},
                  {"V", "WALKXYZ", "OVD-SLAM", "rpe_rotation_rmse", 0.6268}},
                 false);
  EXPECT_EQ(cell(find(tables, "table_4"), kWalking, "chi2 RMSE"), "0.0200");
  EXPECT_EQ(cell(find(tables, "table_4"), kWalking, "paper: OVD-SLAM RMSE"), "0.0207");
  EXPECT_EQ(cell(find(tables, "table_5"), kWalking, "chi2 S.D."), "0.3000");
  EXPECT_EQ(cell(find(tables, "table_5"), kWalking, "paper: OVD-SLAM RMSE"), "0.6268");
}

TEST(ResultTables, RenderedSequencesSayThatTheyAreNotThePapers) {
  const std::vector<RunSummary> runs{runOf("walking_xyz", "hmc", 0.1)};
  for (const char* name : {"table_1", "table_2", "table_3", "table_4", "table_5", "improvement"}) {
    EXPECT_THAT(find(makeTables(runs, {}, true), name).note, HasSubstr("not comparable")) << name;
    EXPECT_THAT(find(makeTables(runs, {}, false), name).note,
                testing::Not(HasSubstr("not comparable")))
        << name;
  }
}

TEST(ResultTables, EveryRowIsAsLongAsTheHeader) {
  for (const ResultTable& table :
       makeTables({runOf(kWalking, "hmc", 0.1), runOf("b", "none", 0.1)}, {}, false)) {
    EXPECT_FALSE(table.rows.empty()) << table.name;
    for (const std::vector<std::string>& row : table.rows) {
      EXPECT_EQ(row.size(), table.header.size()) << table.name;
    }
  }
}

TEST(ResultTables, AreWrittenAsMarkdownAndCsv) {
  const ResultTable table{"name", "Title", "A note.", {"a", "b"}, {{"1", "2, 3"}, {"\"x\"", "-"}}};
  EXPECT_EQ(toMarkdown(table),
            "## Title\n\n| a | b |\n|---|---|\n| 1 | 2, 3 |\n| \"x\" | - |\n\nA note.\n");
  EXPECT_EQ(toCsv(table), "a,b\n1,\"2, 3\"\n\"\"\"x\"\"\",-\n");
}

TEST(PaperSequence, KnowsTumBonnAndRenderedNames) {
  EXPECT_EQ(paperSequence("rgbd_dataset_freiburg3_walking_xyz"), "WALKXYZ");
  EXPECT_EQ(paperSequence("rgbd_dataset_freiburg3_sitting_halfsphere"), "SITHALF");
  EXPECT_EQ(paperSequence("rgbd_bonn_crowd2"), "CROWD2");
  EXPECT_EQ(paperSequence("rgbd_bonn_synchronous2"), "SYCH2");
  EXPECT_EQ(paperSequence("walking_static"), "WALKSTATIC");
  EXPECT_EQ(paperSequence("rgbd_bonn_balloon"), "");
  EXPECT_EQ(paperSequence("walking_xyz_2"), "");
  EXPECT_EQ(paperSequence(""), "");
}

}  // namespace
}  // namespace hmcdyn::evaluate

// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/run_summary.hpp"

#include <filesystem>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "evaluate/paper_results.hpp"
#include "temporary_folder.hpp"

namespace hmcdyn::evaluate {
namespace {

using testing::HasSubstr;

const std::string kComplete = R"({
  "counts": {"frames_in": 49, "frames_tracked": 48, "stopped_by_signal": false},
  "tracking_cpu_ms": 12.5,
  "evaluation": {
    "ate_m": {"rmse": 0.015, "std": 0.008, "mean": 0.012},
    "rpe_translation_m_per_s": {"rmse": 0.02, "std": 0.01},
    "rpe_rotation_deg_per_s": {"rmse": 0.6, "std": 0.3}}})";

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  const std::size_t at = text.find(what);
  if (at == std::string::npos) {
    throw std::runtime_error("no " + what);
  }
  return text.replace(at, what.size(), with);
}

class RunSummaries : public test::TemporaryFolder {
 protected:
  std::string errorOf(const std::string& content) const {
    try {
      readRunSummary(write("summary.json", content));
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "nothing thrown";
  }
  void addRun(const std::string& folder, const std::string& content) const {
    std::filesystem::create_directories(path(folder));
    write(folder + "/summary.json", content);
  }
};

TEST_F(RunSummaries, AreReadFromJson) {
  const RunSummary run = readRunSummary(write("summary.json", kComplete));
  EXPECT_EQ(run.frames, 49U);
  EXPECT_EQ(run.tracked, 48U);
  EXPECT_EQ(run.tracking_ms, 12.5);
  EXPECT_EQ(run.ate.value().rmse, 0.015);
  EXPECT_EQ(run.ate.value().sd, 0.008);
  EXPECT_EQ(run.translation.value().rmse, 0.02);
  EXPECT_EQ(run.rotation.value().sd, 0.3);
}

TEST_F(RunSummaries, WithoutAGroundTruthThereAreNoErrors) {
  const RunSummary run = readRunSummary(
      write("summary.json",
            R"({"counts": {"frames_in": 5, "frames_tracked": 0, "stopped_by_signal": false},
          "tracking_cpu_ms": 3, "evaluation": {"error": "no pose"}})"));
  EXPECT_EQ(run.tracked, 0U);
  EXPECT_FALSE(run.ate.has_value());
  EXPECT_FALSE(run.translation.has_value());
  EXPECT_FALSE(run.rotation.has_value());
}

TEST_F(RunSummaries, WhatIsNotFinishedIsRefused) {
  EXPECT_EQ(errorOf(kComplete), "nothing thrown");
  // Every cut of the file, as a full disk or a kill leaves it
  for (std::size_t length = 0; length + 1 < kComplete.size(); length += 7) {
    EXPECT_THAT(errorOf(kComplete.substr(0, length)), HasSubstr("is no complete summary"))
        << length;
  }
  EXPECT_THAT(errorOf("{}"), HasSubstr("is no complete summary"));
  EXPECT_THAT(
      errorOf(replaced(kComplete, "\"stopped_by_signal\": false", "\"stopped_by_signal\": true")),
      HasSubstr("stopped before its end"));
  EXPECT_THAT(errorOf(replaced(kComplete, "\"stopped_by_signal\": false",
                               "\"stopped_by_signal\": false, \"write_failures\": [\"full\"]")),
              HasSubstr("could not write its results: full"));
  EXPECT_THAT(
      errorOf(replaced(kComplete, "\"counts\"",
                       "\"errors\": [{\"part\": \"loop closing\", \"error\": \"too late\"}], "
                       "\"counts\"")),
      HasSubstr("loop closing failed in the run: too late"));
  EXPECT_THAT(errorOf(replaced(kComplete, "\"frames_in\": 49", "\"frames_in\": 0")),
              HasSubstr("48 of 0 frames tracked"));
  EXPECT_THAT(errorOf(replaced(kComplete, "\"frames_in\": 49", "\"frames_in\": 40")),
              HasSubstr("48 of 40 frames tracked"));
  EXPECT_THAT(errorOf(replaced(kComplete, "0.015", "-1")), HasSubstr("rmse is -1"));
  EXPECT_THAT(errorOf(replaced(kComplete, "0.015", "null")), HasSubstr("is no complete summary"));
  EXPECT_THROW(readRunSummary(path("missing.json")), std::runtime_error);
}

TEST_F(RunSummaries, AreCollectedByName) {
  addRun("runs/crowd/none/seed1", kComplete);
  addRun("runs/crowd/hmc/seed2", kComplete);
  addRun("runs/crowd/hmc/seed1", kComplete);
  addRun("runs/crowd/hmc/seed3", "{\"counts\": {");
  std::filesystem::create_directories(path("runs/crowd/rs/seed1"));
  write("runs/progress.log", "not a folder");
  const RunCollection collection = collectRuns(path("runs"));
  ASSERT_EQ(collection.runs.size(), 3U);
  EXPECT_EQ(collection.runs[0].sequence, "crowd");
  EXPECT_EQ(collection.runs[0].variant, "hmc");
  EXPECT_EQ(collection.runs[0].name, "seed1");
  EXPECT_EQ(collection.runs[1].name, "seed2");
  EXPECT_EQ(collection.runs[2].variant, "none");
  ASSERT_EQ(collection.unfinished.size(), 2U);
  EXPECT_THAT(collection.unfinished[0], HasSubstr("hmc/seed3/summary.json"));
  EXPECT_THAT(collection.unfinished[1], HasSubstr("rs/seed1/summary.json: cannot be read"));
  EXPECT_THROW(collectRuns(path("missing")), std::runtime_error);
}

class PaperResults : public test::TemporaryFolder {
 protected:
  std::string errorOf(const std::string& content) const {
    try {
      readPaperResults(write("paper.csv", content));
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "nothing thrown";
  }
};

TEST_F(PaperResults, AreReadAndFound) {
  const std::vector<PaperValue> values = readPaperResults(write(
      "paper.csv", "# source\ntable,sequence,system,metric,value\nI,CROWD,RS,ate_rmse,0.0221\n"));
  ASSERT_EQ(values.size(), 1U);
  EXPECT_EQ(findPaperValue(values, "I", "CROWD", "RS", "ate_rmse"), 0.0221);
  EXPECT_FALSE(findPaperValue(values, "I", "CROWD", "RS", "ate_sd").has_value());
  EXPECT_FALSE(findPaperValue(values, "II", "CROWD", "RS", "ate_rmse").has_value());
}

TEST_F(PaperResults, MalformedLinesAreNamed) {
  const std::string header = "table,sequence,system,metric,value\n";
  EXPECT_THAT(errorOf(header + "I,CROWD,RS,ate_rmse\n"),
              HasSubstr("paper.csv:2: expected 5 fields, found 4"));
  EXPECT_THAT(errorOf(header + "\nI,CROWD,RS,ate_rmse,0.1x\n"),
              HasSubstr("paper.csv:3: '0.1x' is no number"));
  EXPECT_THAT(errorOf(header + "I,CROWD,RS,,0.1\n"),
              HasSubstr("paper.csv:2: a field of 'I,CROWD,RS,,0.1' is empty; expected table,"));
  EXPECT_THAT(errorOf("I,CROWD,RS,ate_rmse,0.1\n"), HasSubstr("paper.csv:1: expected the header"));
  EXPECT_THAT(errorOf(""), HasSubstr("expected the header"));
}

TEST(PaperTables, TheDataFileHasThePapersFigures) {
  // Given the file beside the script; figures read off the paper's tables by hand
  const std::vector<PaperValue> values = readPaperResults(HMCDYN_PAPER_TABLES);
  EXPECT_EQ(values.size(), 56U + 49U + 3U * 100U + 5U);
  EXPECT_EQ(findPaperValue(values, "I", "WALKHALF", "RS", "ate_sd"), 0.3112);
  EXPECT_EQ(findPaperValue(values, "II", "CROWD2", "RS", "tracking_rate"), 78.9);
  EXPECT_FALSE(findPaperValue(values, "II", "CROWD", "DF", "time_ms").has_value());
  EXPECT_EQ(findPaperValue(values, "III", "WALKSTATIC", "OVD-SLAM", "ate_rmse"), 0.0071);
  EXPECT_EQ(findPaperValue(values, "III", "CROWD", "ORB-SLAM3", "ate_rmse"), 1.1212);
  EXPECT_EQ(findPaperValue(values, "IV", "WALKRPY", "HMC", "rpe_translation_rmse"), 0.0432);
  EXPECT_EQ(findPaperValue(values, "V", "WALKRPY", "HMC", "rpe_rotation_sd"), 0.4557);
  EXPECT_EQ(findPaperValue(values, "VI", "mean", "REFUSION", "time_ms"), 128.99);
}

}  // namespace
}  // namespace hmcdyn::evaluate

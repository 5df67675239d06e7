// SPDX-License-Identifier: BSD-3-Clause
#include "support/stage_times.hpp"

#include <cmath>
#include <ctime>
#include <limits>
#include <numeric>
#include <stdexcept>

#include <gtest/gtest.h>

namespace hmcdyn::slam {
namespace {

TEST(TimeStatistics, ByHand) {
  const support::TimeStatistics odd = support::timeStatistics({5.0, 1.0, 3.0});
  EXPECT_DOUBLE_EQ(odd.mean, 3.0);
  EXPECT_DOUBLE_EQ(odd.median, 3.0);
  EXPECT_DOUBLE_EQ(odd.p95, 5.0);
  const support::TimeStatistics even = support::timeStatistics({4.0, 1.0, 2.0, 9.0});
  EXPECT_DOUBLE_EQ(even.mean, 4.0);
  EXPECT_DOUBLE_EQ(even.median, 3.0);
}

TEST(TimeStatistics, P95LeavesAtMostATwentiethAbove) {
  std::vector<double> values(100);
  std::iota(values.begin(), values.end(), 1.0);
  EXPECT_DOUBLE_EQ(support::timeStatistics(values).p95, 95.0);
  EXPECT_DOUBLE_EQ(support::timeStatistics(values).max, 100.0);
  values.resize(20);  // 1 .. 20
  EXPECT_DOUBLE_EQ(support::timeStatistics(values).p95, 19.0);
  EXPECT_DOUBLE_EQ(support::timeStatistics({7.0}).p95, 7.0);
}

TEST(TimeStatistics, OfNothingIsZeroAndNaNIsRefused) {
  const support::TimeStatistics none = support::timeStatistics({});
  EXPECT_EQ(none.mean, 0.0);
  EXPECT_EQ(none.median, 0.0);
  EXPECT_EQ(none.p95, 0.0);
  EXPECT_EQ(none.max, 0.0);
  EXPECT_THROW(support::timeStatistics({1.0, std::nan("")}), std::invalid_argument);
  EXPECT_THROW(support::timeStatistics({std::numeric_limits<double>::infinity()}),
               std::invalid_argument);
}

TEST(StageTimer, BothClocksRunWhileTheThreadWorks) {
  // Spins until its own processor clock has advanced: no fixed amount of time is assumed.
  const support::StageTimer timer;
  const std::clock_t start = std::clock();
  while (timer.elapsed("work").cpu_ms < 1.0 && std::clock() - start < 10 * CLOCKS_PER_SEC) {
  }
  const support::StageTime time = timer.elapsed("work");
  EXPECT_EQ(time.stage, "work");
  EXPECT_GE(time.cpu_ms, 1.0);
  EXPECT_GT(time.wall_ms, 0.0);
}

TEST(StageTimes, KeepTheirOrderAndAddUp) {
  support::StageTimes times;
  times.add({"track", 2.0, 1.0});
  times.add({"detect", 5.0, 4.0});
  times.add({"track", 0.5, 0.25});
  ASSERT_EQ(times.stages().size(), 2U);
  EXPECT_EQ(times.stages()[0].stage, "track");
  EXPECT_DOUBLE_EQ(times.stages()[0].wall_ms, 2.5);
  EXPECT_DOUBLE_EQ(times.stages()[0].cpu_ms, 1.25);
  EXPECT_EQ(times.stages()[1].stage, "detect");
  ASSERT_NE(times.find("detect"), nullptr);
  EXPECT_EQ(times.find("detect")->cpu_ms, 4.0);
  EXPECT_EQ(times.find("map"), nullptr);
}

TEST(StageTimes, MeasureHandsOnWhatTheWorkReturns) {
  support::StageTimes times;
  int calls = 0;
  EXPECT_EQ(times.measure("value", [&] { return ++calls + 41; }), 42);
  times.measure("nothing", [&] { ++calls; });
  EXPECT_EQ(calls, 2);
  ASSERT_EQ(times.stages().size(), 2U);
  EXPECT_GE(times.stages()[0].wall_ms, 0.0);
}

TEST(StageTimes, WorkThatThrowsIsNotNoted) {
  support::StageTimes times;
  EXPECT_THROW(times.measure("bad", []() -> int { throw std::runtime_error("no"); }),
               std::runtime_error);
  EXPECT_TRUE(times.stages().empty());
}

TEST(StageHistory, CountsOnlyTheFramesThatRanAStage) {
  std::vector<support::StageTimes> frames(3);
  frames[0].add({"track", 1.0, 0.5});
  frames[1].add({"track", 3.0, 1.5});
  frames[1].add({"map", 10.0, 8.0});
  frames[2].add({"track", 2.0, 1.0});
  support::StageHistory history;
  EXPECT_TRUE(history.summarize().empty());
  for (const support::StageTimes& frame : frames) {
    history.add(frame);
  }
  const std::vector<support::StageSummary> summaries = history.summarize();
  ASSERT_EQ(summaries.size(), 2U);
  EXPECT_EQ(summaries[0].stage, "track");
  EXPECT_EQ(summaries[0].frames, 3U);
  EXPECT_DOUBLE_EQ(summaries[0].wall_ms.mean, 2.0);
  EXPECT_DOUBLE_EQ(summaries[0].wall_ms.p95, 3.0);
  EXPECT_DOUBLE_EQ(summaries[0].cpu_ms.median, 1.0);
  EXPECT_EQ(summaries[1].stage, "map");
  EXPECT_EQ(summaries[1].frames, 1U);
  EXPECT_DOUBLE_EQ(summaries[1].wall_ms.mean, 10.0);
}

}  // namespace
}  // namespace hmcdyn::slam

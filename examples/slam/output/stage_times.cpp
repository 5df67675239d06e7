// SPDX-License-Identifier: BSD-3-Clause
#include "slam/output/stage_times.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <numeric>

namespace hmcdyn::slam {
namespace {

double readClock(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
}

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

StageSummary summarizeStage(std::vector<double> wall, const std::vector<double>& cpu) {
  std::sort(wall.begin(), wall.end());
  const std::size_t n = wall.size();
  StageSummary summary;
  summary.frames = n;
  summary.mean_ms = mean(wall);
  summary.mean_cpu_ms = mean(cpu);
  summary.median_ms = n % 2 == 1 ? wall[n / 2] : 0.5 * (wall[n / 2 - 1] + wall[n / 2]);
  const auto rank = static_cast<std::size_t>(std::ceil(0.95 * static_cast<double>(n)));
  summary.p95_ms = wall[rank - 1];
  return summary;
}

}  // namespace

Instant readClocks() { return {readClock(CLOCK_MONOTONIC), readClock(CLOCK_THREAD_CPUTIME_ID)}; }

void StageTimes::note(const std::string& stage, const Instant& start) {
  const Instant now = readClocks();
  stages_.push_back({stage, now.wall_ms - start.wall_ms, now.cpu_ms - start.cpu_ms});
}

std::map<std::string, StageSummary> summarize(const std::vector<StageTimes>& frames) {
  std::map<std::string, std::vector<double>> wall;
  std::map<std::string, std::vector<double>> cpu;
  for (const StageTimes& frame : frames) {
    for (const StageTime& time : frame.stages()) {
      wall[time.stage].push_back(time.wall_ms);
      cpu[time.stage].push_back(time.cpu_ms);
    }
  }
  std::map<std::string, StageSummary> summaries;
  for (const auto& [stage, values] : wall) {
    summaries.emplace(stage, summarizeStage(values, cpu.at(stage)));
  }
  return summaries;
}

}  // namespace hmcdyn::slam

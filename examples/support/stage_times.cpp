// SPDX-License-Identifier: BSD-3-Clause
#include "support/stage_times.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <numeric>
#include <stdexcept>

namespace hmcdyn::support {
namespace {

double wallMs() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration<double, std::milli>(now).count();
}

double threadCpuMs() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_nsec) * 1e-6;
}

template <class Stages>
auto findStage(Stages& stages, const std::string& stage) {
  return std::find_if(stages.begin(), stages.end(),
                      [&](const StageTime& time) { return time.stage == stage; });
}

}  // namespace

StageTimer::StageTimer() : wall_start_ms_(wallMs()), cpu_start_ms_(threadCpuMs()) {}

StageTime StageTimer::elapsed(std::string stage) const {
  return {std::move(stage), wallMs() - wall_start_ms_, threadCpuMs() - cpu_start_ms_};
}

void StageTimes::add(const StageTime& time) {
  const auto known = findStage(stages_, time.stage);
  if (known == stages_.end()) {
    stages_.push_back(time);
  } else {
    known->wall_ms += time.wall_ms;
    known->cpu_ms += time.cpu_ms;
  }
}

void StageTimes::prepend(const StageTimes& before) {
  StageTimes all = before;
  for (const StageTime& time : stages_) {
    all.add(time);
  }
  *this = std::move(all);
}

const StageTime* StageTimes::find(const std::string& stage) const noexcept {
  const auto known = findStage(stages_, stage);
  return known == stages_.end() ? nullptr : &*known;
}

TimeStatistics timeStatistics(std::vector<double> values) {
  if (!std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); })) {
    throw std::invalid_argument("time statistics: a value is not finite");
  }
  if (values.empty()) {
    return {};
  }
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  const std::size_t rank = (95 * n + 99) / 100;  // ceil(0.95 n)
  return {std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(n),
          0.5 * (values[(n - 1) / 2] + values[n / 2]), values[rank - 1], values.back()};
}

void StageHistory::add(const StageTimes& frame) {
  for (const StageTime& time : frame.stages()) {
    auto stage = std::find_if(stages_.begin(), stages_.end(),
                              [&](const Stage& known) { return known.name == time.stage; });
    if (stage == stages_.end()) {
      stage = stages_.insert(stages_.end(), Stage{time.stage, {}, {}});
    }
    stage->wall_ms.push_back(static_cast<float>(time.wall_ms));
    stage->cpu_ms.push_back(static_cast<float>(time.cpu_ms));
  }
}

std::vector<StageSummary> StageHistory::summarize() const {
  std::vector<StageSummary> summaries;
  for (const Stage& stage : stages_) {
    summaries.push_back({stage.name, stage.wall_ms.size(),
                         timeStatistics({stage.wall_ms.begin(), stage.wall_ms.end()}),
                         timeStatistics({stage.cpu_ms.begin(), stage.cpu_ms.end()})});
  }
  return summaries;
}

}  // namespace hmcdyn::support

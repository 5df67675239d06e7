// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace hmcdyn::support {

/// What a stage of a frame took.
struct StageTime {
  std::string stage;
  double wall_ms = 0.0;  ///< Time that passed (ms).
  double cpu_ms = 0.0;   ///< Processor time of the thread that measured (ms).
};

/// A stopwatch that runs from its construction. CPU time is that of the calling thread: construct
/// and read it in one thread.
class StageTimer {
 public:
  StageTimer();

  StageTime elapsed(std::string stage) const;

 private:
  double wall_start_ms_;
  double cpu_start_ms_;
};

/// The stages of one frame, in the order in which they were first noted.
class StageTimes {
 public:
  /// Times of a stage that ran several times in the frame add up.
  void add(const StageTime& time);

  /// The stages of `before` come first, those that are here already behind them.
  void prepend(const StageTimes& before);

  /// Runs `work`, notes what it took and hands on what it returns. Nothing is noted when it throws.
  template <class Work>
  std::invoke_result_t<Work> measure(std::string stage, Work&& work) {
    const StageTimer timer;
    if constexpr (std::is_void_v<std::invoke_result_t<Work>>) {
      std::forward<Work>(work)();
      add(timer.elapsed(std::move(stage)));
    } else {
      std::invoke_result_t<Work> result = std::forward<Work>(work)();
      add(timer.elapsed(std::move(stage)));
      return result;
    }
  }

  const std::vector<StageTime>& stages() const noexcept { return stages_; }
  /// The stage's time, or null where the frame did not run it. Valid until the next change.
  const StageTime* find(const std::string& stage) const noexcept;

 private:
  std::vector<StageTime> stages_;
};

/// Of times in ms. The median of an even count is the mean of the middle two; p95 is the smallest
/// value that at least 95 % of the values do not exceed.
struct TimeStatistics {
  double mean = 0.0;
  double median = 0.0;
  double p95 = 0.0;
  double max = 0.0;
};

/// All 0 for no values. @throws std::invalid_argument on a value that is not finite.
TimeStatistics timeStatistics(std::vector<double> values);

/// A stage over the frames that ran it.
struct StageSummary {
  std::string stage;
  std::size_t frames = 0;
  TimeStatistics wall_ms;
  TimeStatistics cpu_ms;
};

/// The stage times of all frames of a run, in 8 bytes a stage and frame.
class StageHistory {
 public:
  void add(const StageTimes& frame);

  /// By stage, in the order in which the stages first occurred.
  std::vector<StageSummary> summarize() const;

 private:
  struct Stage {
    std::string name;
    std::vector<float> wall_ms;
    std::vector<float> cpu_ms;
  };
  std::vector<Stage> stages_;
};

}  // namespace hmcdyn::support

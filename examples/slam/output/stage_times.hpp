// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace hmcdyn::slam {

/// What a stage of a frame took.
struct StageTime {
  std::string stage;
  double wall_ms = 0.0;  ///< Time that passed (ms).
  double cpu_ms = 0.0;   ///< Processor time of the calling thread (ms).
};

/// A clock reading.
struct Instant {
  double wall_ms = 0.0;
  double cpu_ms = 0.0;
};

/// Now, by the monotonic clock and the calling thread's processor clock.
Instant readClocks();

/// The stages of one frame, in the order in which they ran.
class StageTimes {
 public:
  /// Runs `work`, notes what it took under the stage's name, and hands on what it returns. Nothing
  /// is noted when it throws.
  template <class Work>
  auto measure(const std::string& stage, Work&& work) {
    const Instant start = readClocks();
    if constexpr (std::is_void_v<decltype(work())>) {
      std::forward<Work>(work)();
      note(stage, start);
    } else {
      auto result = std::forward<Work>(work)();
      note(stage, start);
      return result;
    }
  }

  const std::vector<StageTime>& stages() const noexcept { return stages_; }

 private:
  void note(const std::string& stage, const Instant& start);

  std::vector<StageTime> stages_;
};

/// Mean, median and 95th percentile of a stage over the frames (ms). Of an even count the median is
/// the mean of the middle two; the percentile is the smallest value that 95 % do not exceed.
struct StageSummary {
  std::size_t frames = 0;
  double mean_ms = 0.0;
  double median_ms = 0.0;
  double p95_ms = 0.0;
  double mean_cpu_ms = 0.0;
};

/// By stage. A stage that a frame did not run is not counted for it.
std::map<std::string, StageSummary> summarize(const std::vector<StageTimes>& frames);

}  // namespace hmcdyn::slam

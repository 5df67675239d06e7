// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace hmcdyn::support {

/// A progress bar on standard error with rate and time left: redrawn in place on a terminal, a
/// line every ten per cent elsewhere (logs, CI). Counts from construction.
class ProgressBar {
 public:
  /// @param label what is counted, e.g. "frames"; @param total how many there will be.
  ProgressBar(std::string label, std::size_t total, bool enabled = true);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;
  ProgressBar(ProgressBar&&) = delete;
  ProgressBar& operator=(ProgressBar&&) = delete;

  /// `done` of the total are finished; `note` is shown behind the bar.
  void update(std::size_t done, const std::string& note = {});

 private:
  using Clock = std::chrono::steady_clock;

  std::string label_;
  std::size_t total_;
  bool enabled_;
  bool terminal_;
  Clock::time_point start_ = Clock::now();
  Clock::time_point last_draw_{};
  std::size_t last_tenth_ = 0;
  bool drawn_ = false;
};

/// "1:05" or "2:03:04".
std::string formatDuration(double seconds);

}  // namespace hmcdyn::support

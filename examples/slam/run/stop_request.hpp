// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <atomic>
#include <csignal>

namespace hmcdyn::slam {

/// While it lives, SIGINT (Ctrl-C) and SIGTERM ask the program to stop instead of ending it: the
/// run loop reads requested() and finishes what it has. A second of these signals ends the program
/// at once, as does the first one after the object's end. System calls that a signal would
/// interrupt go on. At most one may live at a time, since a process has one handler a signal.
class StopRequest {
 public:
  /// @throws std::logic_error where another one lives.
  /// @throws std::system_error where the handlers cannot be installed.
  StopRequest();
  ~StopRequest();
  StopRequest(const StopRequest&) = delete;
  StopRequest& operator=(const StopRequest&) = delete;
  StopRequest(StopRequest&&) = delete;
  StopRequest& operator=(StopRequest&&) = delete;

  /// True from the first signal on. Any thread may ask.
  bool requested() const noexcept;

  /// Becomes true with it, for those who take a flag; lives as long as the program.
  const std::atomic<bool>& flag() const noexcept;

  /// The signal that came, SIGINT or SIGTERM; 0 = none.
  int signal() const noexcept;

 private:
  static constexpr std::array<int, 2> kSignals{SIGINT, SIGTERM};

  std::array<struct sigaction, 2> previous_{};
};

}  // namespace hmcdyn::slam

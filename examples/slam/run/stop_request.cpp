// SPDX-License-Identifier: BSD-3-Clause
#include "slam/run/stop_request.hpp"

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <stdexcept>
#include <system_error>

namespace hmcdyn::slam {
namespace {

// A signal handler can reach nothing else than a variable of the whole program. Lock-free, so that
// the handler may write it and other threads may read it.
std::atomic<int> received_signal{0};
std::atomic<bool> any_signal{false};
std::atomic<bool> installed{false};
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<bool>::is_always_lock_free);

extern "C" void onStopSignal(int signal) {
  any_signal = true;
  int none = 0;
  if (!received_signal.compare_exchange_strong(none, signal)) {
    // Delivered when this handler returns, and then it is the end.
    std::signal(signal, SIG_DFL);
    std::raise(signal);
  }
}

}  // namespace

StopRequest::StopRequest() {
  if (installed.exchange(true)) {
    throw std::logic_error("StopRequest: another one lives; expected one at a time");
  }
  received_signal = 0;
  any_signal = false;
  struct sigaction action {};
  action.sa_handler = onStopSignal;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    if (sigaction(kSignals[i], &action, &previous_[i]) != 0) {
      const int reason = errno;
      installed = false;
      throw std::system_error(reason, std::generic_category(), "StopRequest: sigaction");
    }
  }
}

StopRequest::~StopRequest() {
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    sigaction(kSignals[i], &previous_[i], nullptr);
  }
  installed = false;
}

bool StopRequest::requested() const noexcept { return signal() != 0; }

// NOLINTNEXTLINE(readability-convert-member-functions-to-static): asked of the one that lives
const std::atomic<bool>& StopRequest::flag() const noexcept { return any_signal; }

// NOLINTNEXTLINE(readability-convert-member-functions-to-static): asked of the one that lives
int StopRequest::signal() const noexcept { return received_signal; }

}  // namespace hmcdyn::slam

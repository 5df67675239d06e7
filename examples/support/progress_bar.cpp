// SPDX-License-Identifier: BSD-3-Clause
#include "support/progress_bar.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <unistd.h>
#include <utility>

namespace hmcdyn::support {

std::string formatDuration(double seconds) {
  const auto total = static_cast<long>(std::lround(std::max(0.0, seconds)));
  char text[32];
  if (total >= 3600) {
    std::snprintf(text, sizeof text, "%ld:%02ld:%02ld", total / 3600, total / 60 % 60, total % 60);
  } else {
    std::snprintf(text, sizeof text, "%ld:%02ld", total / 60, total % 60);
  }
  return text;
}

ProgressBar::ProgressBar(std::string label, std::size_t total, bool enabled)
    : label_(std::move(label)),
      total_(total),
      enabled_(enabled && total > 0),
      terminal_(isatty(STDERR_FILENO) != 0) {}

ProgressBar::~ProgressBar() {
  if (drawn_ && terminal_) {
    std::fputc('\n', stderr);
  }
}

void ProgressBar::update(std::size_t done, const std::string& note) {
  if (!enabled_) {
    return;
  }
  const auto now = Clock::now();
  const bool last = done >= total_;
  const std::size_t tenth = done * 10 / total_;
  if (terminal_ ? (!last && now - last_draw_ < std::chrono::milliseconds(100))
                : (tenth <= last_tenth_)) {
    return;
  }
  last_draw_ = now;
  last_tenth_ = tenth;
  drawn_ = true;

  const double elapsed = std::chrono::duration<double>(now - start_).count();
  const double rate = elapsed > 0.0 ? static_cast<double>(done) / elapsed : 0.0;
  const double left =
      rate > 0.0 ? static_cast<double>(total_ - std::min(done, total_)) / rate : 0.0;
  constexpr std::size_t kWidth = 30;
  const std::size_t filled = std::min(kWidth, done * kWidth / total_);
  const std::string bar = std::string(filled, '#') + std::string(kWidth - filled, '.');
  std::fprintf(stderr, "%s[%s] %zu/%zu %s  %.1f/s  %s left  %s%s", terminal_ ? "\r" : "",
               bar.c_str(), done, total_, label_.c_str(), rate, formatDuration(left).c_str(),
               note.c_str(), terminal_ ? "\033[K" : "\n");
  std::fflush(stderr);
}

}  // namespace hmcdyn::support

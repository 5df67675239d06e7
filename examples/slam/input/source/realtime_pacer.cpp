// SPDX-License-Identifier: BSD-3-Clause
#include "slam/input/source/realtime_pacer.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <thread>
#include <utility>

#include <fmt/format.h>

namespace hmcdyn::slam {
namespace {

class WallClock final : public SteadyClock {
 public:
  double now() const override {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }
  void sleepUntil(double time) override {
    std::this_thread::sleep_until(start_ +
                                  std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                      std::chrono::duration<double>(time)));
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace

std::unique_ptr<SteadyClock> makeWallClock() { return std::make_unique<WallClock>(); }

RealtimePacer::RealtimePacer(std::unique_ptr<RecordedSource> source,
                             std::unique_ptr<SteadyClock> clock, double speed, std::size_t held,
                             std::function<bool()> stop, Report report)
    : source_(std::move(source)),
      clock_(std::move(clock)),
      speed_(speed),
      held_(held),
      stop_(std::move(stop)),
      report_(std::move(report)) {
  if (!source_ || !clock_) {
    throw std::invalid_argument(
        fmt::format("RealtimePacer: {} is null", source_ ? "clock" : "source"));
  }
  if (!(speed_ > 0.0) || !std::isfinite(speed_)) {
    throw std::invalid_argument(
        fmt::format("RealtimePacer: speed is {}; expected a finite value above 0", speed_));
  }
  if (held_ == 0) {
    throw std::invalid_argument("RealtimePacer: held is 0; expected 1 image or more");
  }
}

double RealtimePacer::dueTime(double timestamp) const {
  return start_ + (timestamp - *first_timestamp_) / speed_;
}

/// Moves the start so that a frame after a gap is due kLongestWait after the one before it.
void RealtimePacer::cutGap(double timestamp) {
  const double too_long = (timestamp - last_timestamp_) / speed_ - kLongestWait;
  if (!(too_long > 0.0)) {
    return;
  }
  start_ -= too_long;
  if (report_ && !gap_reported_) {
    report_(
        fmt::format("the recording has a gap of {:.1f} s, which is waited for {} s; further "
                    "gaps are not named",
                    timestamp - last_timestamp_, kLongestWait));
  }
  gap_reported_ = true;
}

/// False where it was stopped before.
bool RealtimePacer::waitUntil(double time) {
  constexpr double kAsked = 0.1;  // s
  while (!(stop_ && stop_())) {
    const double now = clock_->now();
    if (now >= time) {
      return true;
    }
    clock_->sleepUntil(stop_ ? std::min(time, now + kAsked) : time);
  }
  return false;
}

std::optional<RgbdFrame> RealtimePacer::next() {
  if (!source_->upcomingTimestamp(0)) {
    return std::nullopt;
  }
  const double now = clock_->now();
  if (!first_timestamp_) {
    first_timestamp_ = source_->upcomingTimestamp(0);
    last_timestamp_ = *first_timestamp_;
    start_ = now;
    due_ = now;
    return source_->next();
  }
  const auto isDue = [&](std::optional<double> timestamp) {
    return timestamp && dueTime(*timestamp) <= now;
  };
  cutGap(*source_->upcomingTimestamp(0));
  while (isDue(source_->upcomingTimestamp(held_))) {
    last_timestamp_ = *source_->upcomingTimestamp(0);
    source_->skip();
    cutGap(*source_->upcomingTimestamp(0));
  }
  last_timestamp_ = *source_->upcomingTimestamp(0);
  due_ = std::max(*due_, dueTime(last_timestamp_));
  return waitUntil(*due_) ? source_->next() : std::nullopt;
}

std::optional<double> RealtimePacer::secondsSinceDue() const {
  return due_ ? std::optional(clock_->now() - *due_) : std::nullopt;
}

}  // namespace hmcdyn::slam

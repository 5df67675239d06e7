// SPDX-License-Identifier: BSD-3-Clause
#include "slam/source/realtime_pacer.hpp"

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
                             std::unique_ptr<SteadyClock> clock, double speed, std::size_t held)
    : source_(std::move(source)), clock_(std::move(clock)), speed_(speed), held_(held) {
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

std::optional<RgbdFrame> RealtimePacer::next() {
  if (!source_->upcomingTimestamp(0)) {
    return std::nullopt;
  }
  const double now = clock_->now();
  if (!first_timestamp_) {
    first_timestamp_ = source_->upcomingTimestamp(0);
    start_ = now;
    due_ = now;
    return source_->next();
  }
  const auto isDue = [&](std::optional<double> timestamp) {
    return timestamp && dueTime(*timestamp) <= now;
  };
  while (isDue(source_->upcomingTimestamp(held_))) {
    source_->skip();
  }
  due_ = std::max(*due_, dueTime(*source_->upcomingTimestamp(0)));
  clock_->sleepUntil(*due_);
  return source_->next();
}

std::optional<double> RealtimePacer::secondsSinceDue() const {
  return due_ ? std::optional(clock_->now() - *due_) : std::nullopt;
}

}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#include "slam/source/realtime_pacer.hpp"

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
                             std::unique_ptr<SteadyClock> clock, double speed)
    : source_(std::move(source)), clock_(std::move(clock)), speed_(speed) {
  if (!source_ || !clock_) {
    throw std::invalid_argument(
        fmt::format("RealtimePacer: {} is null", source_ ? "clock" : "source"));
  }
  if (!(speed_ > 0.0) || !std::isfinite(speed_)) {
    throw std::invalid_argument(
        fmt::format("RealtimePacer: speed is {}; expected a finite value above 0", speed_));
  }
}

double RealtimePacer::dueTime(double timestamp) const {
  return start_ + (timestamp - *first_timestamp_) / speed_;
}

std::optional<RgbdFrame> RealtimePacer::next() {
  std::optional<double> timestamp = source_->nextTimestamp();
  if (!timestamp) {
    return std::nullopt;
  }
  if (!first_timestamp_) {
    first_timestamp_ = timestamp;
    start_ = clock_->now();
    return source_->next();
  }
  const double now = clock_->now();
  for (std::optional<double> after = source_->timestampAfterNext(); after && dueTime(*after) <= now;
       after = source_->timestampAfterNext()) {
    source_->skip();
    timestamp = after;
  }
  clock_->sleepUntil(dueTime(*timestamp));
  return source_->next();
}

}  // namespace hmcdyn::slam

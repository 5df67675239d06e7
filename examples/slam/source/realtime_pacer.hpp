// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "slam/source/frame_source.hpp"

namespace hmcdyn::slam {

/// A clock that never goes back.
class SteadyClock {
 public:
  SteadyClock() = default;
  virtual ~SteadyClock() = default;
  SteadyClock(const SteadyClock&) = delete;
  SteadyClock& operator=(const SteadyClock&) = delete;
  SteadyClock(SteadyClock&&) = delete;
  SteadyClock& operator=(SteadyClock&&) = delete;

  /// Seconds since some moment in the past.
  virtual double now() const = 0;

  /// Returns when now() has reached `time`; at once where it has.
  virtual void sleepUntil(double time) = 0;
};

/// The machine's steady clock.
std::unique_ptr<SteadyClock> makeWallClock();

/// Delivers the frames of a recording as a live camera would: each when its time stamp says so,
/// counted from the first frame. A frame is late, and dropped without being loaded, when the one
/// behind it is due as well: a camera hands out its newest image. The last frame is always
/// delivered. Time stamps that stand still or go back are due at once.
class RealtimePacer final : public FrameSource {
 public:
  /// @param speed times the recording's; above 0.
  /// @throws std::invalid_argument for null pointers or another speed.
  RealtimePacer(std::unique_ptr<RecordedSource> source, std::unique_ptr<SteadyClock> clock,
                double speed = 1.0);

  std::optional<RgbdFrame> next() override;
  std::optional<std::size_t> expectedFrames() const override { return source_->expectedFrames(); }
  std::string name() const override { return source_->name() + " in real time"; }
  SourceCounts counts() const override { return source_->counts(); }
  std::string failure() const override { return source_->failure(); }

 private:
  double dueTime(double timestamp) const;

  std::unique_ptr<RecordedSource> source_;
  std::unique_ptr<SteadyClock> clock_;
  double speed_;
  std::optional<double> first_timestamp_;
  double start_ = 0.0;  ///< Of the clock, when the first frame was taken up (s).
};

}  // namespace hmcdyn::slam

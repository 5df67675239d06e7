// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "slam/input/source/frame_source.hpp"

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
/// counted from the first frame. A camera's driver holds a few images for a program that is late;
/// when they are all taken and another image comes, the oldest is dropped, here without being
/// loaded. The last images are always delivered. Time stamps that stand still or go back are due at
/// once. A gap of the recording does not last longer than kLongestWait here: what follows it is due
/// then, and keeps its own pace.
class RealtimePacer final : public FrameSource {
 public:
  /// The longest time between two frames (s of the clock): twice the 2 s for which boxes may be
  /// carried, so that nothing here can tell a longer gap from this one.
  static constexpr double kLongestWait = 4.0;

  /// @param source can tell the time stamps of `held` + 1 frames.
  /// @param speed times the recording's; above 0.
  /// @param held images that wait at most; 1: only the newest, as there is.
  /// @param stop is asked while it waits, ten times a second; true ends the frames.
  /// @param report is told of the first gap; may be empty.
  /// @throws std::invalid_argument for null pointers, another speed, or none held.
  RealtimePacer(std::unique_ptr<RecordedSource> source, std::unique_ptr<SteadyClock> clock,
                double speed = 1.0, std::size_t held = 1, std::function<bool()> stop = {},
                Report report = {});

  std::optional<RgbdFrame> next() override;
  std::optional<std::size_t> expectedFrames() const override { return source_->expectedFrames(); }
  std::string name() const override { return source_->name() + " in real time"; }
  SourceCounts counts() const override { return source_->counts(); }
  std::optional<double> secondsSinceDue() const override;
  std::string failure() const override { return source_->failure(); }

 private:
  double dueTime(double timestamp) const;
  void cutGap(double timestamp);
  bool waitUntil(double time);

  std::unique_ptr<RecordedSource> source_;
  std::unique_ptr<SteadyClock> clock_;
  double speed_;
  std::size_t held_;
  std::function<bool()> stop_;
  Report report_;
  bool gap_reported_ = false;
  std::optional<double> first_timestamp_;
  double last_timestamp_ = 0.0;  ///< Of the frame before (s).
  double start_ = 0.0;           ///< Of the clock, when the first frame was taken up (s).
  std::optional<double> due_;    ///< When the last frame was (s).
};

}  // namespace hmcdyn::slam

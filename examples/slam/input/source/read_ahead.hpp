// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "slam/input/source/frame_source.hpp"
#include "support/worker.hpp"

namespace hmcdyn::slam {

/// Loads the frames of a recording on a thread of its own, some ahead of their use: a camera hands
/// out images, and decoding files is not to count against real time.
class ReadAhead final : public RecordedSource {
 public:
  /// @param source is used by the thread alone from now on; so is what it reports to.
  /// @param in_sight frames whose time stamps can be asked for; two more are loaded ahead.
  /// @throws std::invalid_argument for no source, or no frame in sight.
  explicit ReadAhead(std::unique_ptr<RecordedSource> source, std::size_t in_sight = 2);

  std::optional<RgbdFrame> next() override;
  std::optional<std::size_t> expectedFrames() const override { return expected_frames_; }
  std::string name() const override { return name_; }
  /// Of the frames that were handed out or skipped, not of those that wait.
  SourceCounts counts() const override;
  std::string failure() const override { return failure_; }

  /// Nothing, too, beyond the frames in sight.
  std::optional<double> upcomingTimestamp(std::size_t before) const override;
  void skip() override;

 private:
  struct Loaded {
    std::optional<RgbdFrame> frame;  ///< None at the end.
    SourceCounts counts;             ///< The source's, when this frame was loaded.
    std::string failure;
  };

  void fill();
  void takeFirst();

  std::optional<std::size_t> expected_frames_;
  std::string name_;
  std::size_t in_sight_;
  std::deque<Loaded> loaded_;  ///< The frames in sight, or what is left.
  SourceCounts counts_;
  std::size_t skipped_ = 0;
  std::string failure_;
  std::unique_ptr<RecordedSource> source_;
  support::Worker<std::monostate, Loaded> worker_;  // the last member: its thread uses the others
};

}  // namespace hmcdyn::slam

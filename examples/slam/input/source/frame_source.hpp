// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>

#include "slam/input/dataset/frame.hpp"

namespace hmcdyn::slam {

/// Takes one line for the user, such as spdlog::warn.
using Report = std::function<void(const std::string& message)>;

/// What a source counted so far.
struct SourceCounts {
  std::size_t taken_up = 0;       ///< Frames that came, whatever became of them.
  std::size_t unpaired = 0;       ///< Colour images that no depth image belongs to: no frames.
  std::size_t unreadable = 0;     ///< Left out: damaged, of another size, out of order.
  std::size_t dropped = 0;        ///< Left out: late, in real time.
  std::size_t without_depth = 0;  ///< Delivered, but no pixel has a depth.
};

/// Where frames come from, one after the other. Used by one thread.
class FrameSource {
 public:
  FrameSource() = default;
  virtual ~FrameSource() = default;
  FrameSource(const FrameSource&) = delete;
  FrameSource& operator=(const FrameSource&) = delete;
  FrameSource(FrameSource&&) = delete;
  FrameSource& operator=(FrameSource&&) = delete;

  /// The next frame that can be used, as the camera saw it; nothing at the end. Frames that cannot
  /// be used are reported, counted and left out.
  virtual std::optional<RgbdFrame> next() = 0;

  /// Frames from begin to end, where that is known: a camera goes on until it is stopped.
  virtual std::optional<std::size_t> expectedFrames() const = 0;

  /// What the frames come from, for reports: "folder rgbd_dataset_freiburg3_walking_xyz".
  virtual std::string name() const = 0;

  virtual SourceCounts counts() const = 0;

  /// Time (s) since the last frame was due; nothing where no clock says when frames come.
  virtual std::optional<double> secondsSinceDue() const { return std::nullopt; }

  /// Why the frames ended before their time, such as an unplugged camera; empty = they did not.
  virtual std::string failure() const { return {}; }
};

/// A source whose time stamps are known before its frames are loaded.
class RecordedSource : public FrameSource {
 public:
  /// Time stamp (s) of the frame that next() takes up after `before` others; nothing beyond the
  /// end.
  virtual std::optional<double> upcomingTimestamp(std::size_t before) const = 0;

  /// Drops the frame that next() would take up, without loading it.
  virtual void skip() = 0;
};

}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "slam/input/source/frame_source.hpp"

namespace hmcdyn::slam {

/// A recording of empty images with these time stamps.
class FakeRecording final : public RecordedSource {
 public:
  explicit FakeRecording(std::vector<double> stamps) : stamps_(std::move(stamps)) {}

  std::optional<RgbdFrame> next() override {
    if (position_ == stamps_.size()) {
      return std::nullopt;
    }
    ++counts_.taken_up;
    RgbdFrame frame;
    frame.index = position_;
    frame.timestamp = stamps_[position_++];
    return frame;
  }
  std::optional<std::size_t> expectedFrames() const override { return stamps_.size(); }
  std::string name() const override { return "recording"; }
  SourceCounts counts() const override { return counts_; }
  std::optional<double> upcomingTimestamp(std::size_t before) const override {
    return before < stamps_.size() - position_ ? std::optional<double>(stamps_[position_ + before])
                                               : std::nullopt;
  }
  void skip() override {
    ++position_;
    ++counts_.taken_up;
    ++counts_.dropped;
  }

 private:
  std::vector<double> stamps_;
  std::size_t position_ = 0;
  SourceCounts counts_;
};

}  // namespace hmcdyn::slam

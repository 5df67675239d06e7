// SPDX-License-Identifier: BSD-3-Clause
#include "slam/input/source/read_ahead.hpp"

#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace hmcdyn::slam {
namespace {

constexpr std::size_t kBeyondSight = 2;  // frames

std::unique_ptr<RecordedSource> checked(std::unique_ptr<RecordedSource> source,
                                        std::size_t in_sight) {
  if (!source) {
    throw std::invalid_argument("ReadAhead: source is null");
  }
  if (in_sight < 1) {
    throw std::invalid_argument("ReadAhead: in_sight is 0; expected 1 or more");
  }
  return source;
}

}  // namespace

ReadAhead::ReadAhead(std::unique_ptr<RecordedSource> source, std::size_t in_sight)
    : in_sight_(in_sight),
      source_(checked(std::move(source), in_sight)),
      worker_(
          [this](std::monostate) {
            Loaded loaded;
            loaded.frame = source_->next();
            loaded.counts = source_->counts();
            loaded.failure = source_->failure();
            return loaded;
          },
          in_sight + kBeyondSight) {
  expected_frames_ = source_->expectedFrames();
  name_ = source_->name();
  for (std::size_t k = 0; k < in_sight + kBeyondSight; ++k) {
    worker_.submit({});
  }
  fill();
}

void ReadAhead::fill() {
  while (loaded_.size() < in_sight_ && (loaded_.empty() || loaded_.back().frame)) {
    loaded_.push_back(worker_.take());
    if (loaded_.back().frame) {
      worker_.submit({});
    }
  }
}

std::optional<double> ReadAhead::upcomingTimestamp(std::size_t before) const {
  return before < loaded_.size() && loaded_[before].frame
             ? std::optional<double>(loaded_[before].frame->timestamp)
             : std::nullopt;
}

void ReadAhead::takeFirst() {
  counts_ = loaded_.front().counts;
  failure_ = loaded_.front().failure;
  if (loaded_.front().frame) {  // the end stays
    loaded_.pop_front();
    fill();
  }
}

std::optional<RgbdFrame> ReadAhead::next() {
  std::optional<RgbdFrame> frame = loaded_.front().frame;  // shares the images
  takeFirst();
  return frame;
}

void ReadAhead::skip() {
  skipped_ += loaded_.front().frame ? 1 : 0;
  takeFirst();
}

SourceCounts ReadAhead::counts() const {
  SourceCounts counts = counts_;
  counts.dropped += skipped_;
  return counts;
}

}  // namespace hmcdyn::slam

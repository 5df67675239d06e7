// SPDX-License-Identifier: BSD-3-Clause
#include "slam/output/report/frame_history.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace hmcdyn::slam {
namespace {

int importance(const ReportFrame& frame) {
  return frame.failure.empty() ? (frame.key_frame ? 1 : 0) : 2;
}

}  // namespace

FrameHistory::FrameHistory(std::size_t capacity) : capacity_(capacity) {
  if (capacity < 2) {
    throw std::invalid_argument(
        fmt::format("report: capacity for {} frames; expected at least 2", capacity));
  }
}

void FrameHistory::add(ReportFrame frame) {
  frame.number = added_++;
  if (frames_.size() == capacity_) {
    thin();
  }
  frames_.push_back(std::move(frame));
}

void FrameHistory::thin() {
  std::vector<ReportFrame> kept;
  kept.reserve(capacity_);
  for (std::size_t i = 0; i < frames_.size(); i += 2) {
    const bool take_second =
        i + 1 < frames_.size() && importance(frames_[i + 1]) > importance(frames_[i]);
    kept.push_back(std::move(frames_[take_second ? i + 1 : i]));
  }
  frames_ = std::move(kept);
}

std::vector<FramePicture> byPlace(std::vector<FramePicture> pictures,
                                  const std::vector<ReportFrame>& frames) {
  for (FramePicture& picture : pictures) {
    const auto after = std::upper_bound(frames.begin(), frames.end(), picture.frame,
                                        [](std::size_t number, const ReportFrame& frame) {
                                          return number < frame.number.value_or(0);
                                        });
    picture.frame =
        static_cast<std::size_t>(std::max<std::ptrdiff_t>(after - frames.begin(), 1)) - 1;
  }
  return pictures;
}

}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#include "mask/depth_history.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace hmcdyn::internal {
namespace {

constexpr std::array<double, kMaxSelected> kAges = {0.034, 0.1, 0.2, 0.4, 0.7, 1.2, 2.0};
constexpr double kAllYounger = 0.45;  // (s) kept without a gap: the ages above want them
constexpr double kSpacing = 0.095;    // (s) of the others

}  // namespace

void DepthHistory::clear() {
  while (!frames_.empty()) {
    drop(frames_.size() - 1);
  }
}

void DepthHistory::drop(std::size_t index) {
  spare_.push_back(std::move(frames_[index]));
  frames_.erase(frames_.begin() + static_cast<std::ptrdiff_t>(index));
}

SmallFrame DepthHistory::spare() {
  if (spare_.empty()) {
    return {};
  }
  SmallFrame frame = std::move(spare_.back());
  spare_.pop_back();
  return frame;
}

void DepthHistory::push(SmallFrame frame, double max_age) {
  const double now = frame.timestamp;
  frames_.push_back(std::move(frame));
  for (std::size_t i = 1; i + 1 < frames_.size();) {
    if (now - frames_[i].timestamp > kAllYounger &&
        frames_[i].timestamp - frames_[i - 1].timestamp < kSpacing) {
      drop(i);
    } else {
      ++i;
    }
  }
  while (now - frames_.front().timestamp > max_age) {
    drop(0);
  }
}

void DepthHistory::setPose(double timestamp, const Pose& camera_from_world) {
  for (SmallFrame& frame : frames_) {
    if (frame.timestamp == timestamp) {
      frame.camera_from_world = camera_from_world;
    }
  }
}

std::vector<const SmallFrame*> DepthHistory::select(double timestamp,
                                                    std::vector<const SmallFrame*> reuse) const {
  reuse.clear();
  for (const double age : kAges) {
    const SmallFrame* best = nullptr;
    double best_difference = age / 2;
    for (const SmallFrame& frame : frames_) {
      const double difference = std::abs(timestamp - frame.timestamp - age);
      if (difference < best_difference) {
        best = &frame;
        best_difference = difference;
      }
    }
    if (best != nullptr && std::find(reuse.begin(), reuse.end(), best) == reuse.end()) {
      reuse.push_back(best);
    }
  }
  if (reuse.empty() && !frames_.empty()) {
    reuse.push_back(&frames_.back());  // frames come slower than the ages expect
  }
  return reuse;
}

}  // namespace hmcdyn::internal

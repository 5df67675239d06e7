// SPDX-License-Identifier: BSD-3-Clause
#include "slam/output/report/thin_frames.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

namespace hmcdyn::slam {
namespace {

constexpr std::size_t kStretches = 300;
constexpr std::size_t kLoops = 500;
constexpr double kMissing = -std::numeric_limits<double>::infinity();

double orMissing(double value) { return std::isfinite(value) ? value : kMissing; }

double timeOf(const ReportFrame& frame) {
  double sum = 0.0;
  for (const double ms : frame.stage_ms) {
    sum += std::isfinite(ms) ? ms : 0.0;
  }
  return sum;
}

/// What a stretch keeps the largest of.
using Measure = double (*)(const ReportFrame&);
constexpr std::array<Measure, 6> kMeasures{
    [](const ReportFrame& frame) { return frame.failure.empty() ? 0.0 : 1.0; },
    [](const ReportFrame& frame) { return orMissing(frame.error); },
    [](const ReportFrame& frame) { return timeOf(frame); },
    [](const ReportFrame& frame) { return static_cast<double>(frame.dynamic_points); },
    [](const ReportFrame& frame) { return static_cast<double>(frame.boxes); },
    [](const ReportFrame& frame) { return -static_cast<double>(frame.static_points); }};
static_assert(kStretches * (kMeasures.size() + 1) == kMostFramesShown);

/// Keeps the frame of a time stamp, which files round.
void keepFrameOf(double timestamp, const std::vector<ReportFrame>& frames,
                 std::set<std::size_t>& kept) {
  constexpr double kSameStamp = 1e-5;  // s
  const auto found = std::find_if(frames.begin(), frames.end(), [&](const ReportFrame& frame) {
    return std::abs(frame.timestamp - timestamp) < kSameStamp;
  });
  if (found != frames.end()) {
    kept.insert(static_cast<std::size_t>(found - frames.begin()));
  }
}

}  // namespace

std::vector<std::size_t> framesToShow(const ReportInput& input) {
  const std::vector<ReportFrame>& frames = input.frames;
  std::set<std::size_t> kept;
  if (frames.size() <= kMostFramesShown) {
    for (std::size_t i = 0; i < frames.size(); ++i) {
      kept.insert(kept.end(), i);
    }
    return {kept.begin(), kept.end()};
  }
  for (std::size_t stretch = 0; stretch < kStretches; ++stretch) {
    const std::size_t first = stretch * frames.size() / kStretches;
    const std::size_t end = (stretch + 1) * frames.size() / kStretches;
    kept.insert(first);
    for (const Measure measure : kMeasures) {
      std::size_t largest = first;
      for (std::size_t i = first + 1; i < end; ++i) {
        largest = measure(frames[i]) > measure(frames[largest]) ? i : largest;
      }
      kept.insert(largest);
    }
  }
  kept.insert(frames.size() - 1);
  std::size_t loops = 0;
  for (const LoopRow& loop : input.loops) {
    if (loop.refusal.empty() && loops++ < kLoops) {
      keepFrameOf(loop.timestamp, frames, kept);
      keepFrameOf(loop.matched_timestamp, frames, kept);
    }
  }
  return {kept.begin(), kept.end()};
}

}  // namespace hmcdyn::slam

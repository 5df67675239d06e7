// SPDX-License-Identifier: BSD-3-Clause
#include "smoothing.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace hmcdyn::internal {
namespace {

constexpr int kRounds = 2;             // one leaves stripes along rows and columns
constexpr float kThroughHoles = 0.3f;  // share of the coupling that is left where depth is missing
constexpr float kDoubt = 0.5f;         // weight that draws a belief of little evidence to 0

Evidence operator*(float factor, const Evidence& e) {
  return {factor * e.value, factor * e.weight};
}
Evidence operator+(const Evidence& a, const Evidence& b) {
  return {a.value + b.value, a.weight + b.weight};
}
Evidence operator-(const Evidence& a, const Evidence& b) {
  return {a.value - b.value, a.weight - b.weight};
}

void couple(const SmallFrame& frame, const MaskSegmentOptions& options,
            SmoothingWorkspace& workspace) {
  const float most = std::exp(-std::sqrt(2.0f) / options.reach);  // Gastal and Oliveira, eq. 21
  const auto coupling = [&](float a, float b) {
    if (!(a > 0.0f) || !(b > 0.0f)) {
      return most * kThroughHoles;
    }
    const float steps = (a - b) / (options.depth_step * std::min(a, b) + 0.002f);
    const float squared = steps * steps;
    return most / (1.0f + squared * squared);
  };
  const auto width = static_cast<std::size_t>(frame.width);
  workspace.left.assign(frame.size(), 0.0f);
  workspace.above.assign(frame.size(), 0.0f);
  for (std::size_t i = 0; i < frame.size(); ++i) {
    if (i % width != 0) {
      workspace.left[i] = coupling(frame.depth[i], frame.depth[i - 1]);
    }
    if (i >= width) {
      workspace.above[i] = coupling(frame.depth[i], frame.depth[i - width]);
    }
  }
}

void alongRow(const float* left, Evidence* row, std::size_t width, std::vector<Evidence>& own) {
  std::copy(row, row + width, own.begin());
  for (std::size_t x = 1; x < width; ++x) {
    row[x] = row[x] + left[x] * row[x - 1];
  }
  Evidence back;
  for (std::size_t x = width; x-- > 0;) {
    const Evidence from_right = x + 1 < width ? left[x + 1] * back : Evidence{};
    row[x] = row[x] + from_right;
    back = own[x] + from_right;
  }
}

void alongColumns(const std::vector<float>& above, std::size_t width,
                  std::vector<Evidence>& evidence, SmoothingWorkspace& workspace) {
  std::vector<Evidence>& down = workspace.image;
  down = evidence;
  for (std::size_t i = width; i < evidence.size(); ++i) {
    down[i] = down[i] + above[i] * down[i - width];
  }
  // evidence becomes the sum from below, row by row; the own evidence was counted twice
  for (std::size_t i = evidence.size(); i-- > 0;) {
    const std::size_t below = i + width;
    const Evidence own = evidence[i];
    const Evidence up = below < evidence.size() ? own + above[below] * evidence[below] : own;
    down[i] = down[i] + up - own;
    evidence[i] = up;
  }
  evidence.swap(down);
}

}  // namespace

void spreadAlongSurfaces(const SmallFrame& frame, const MaskSegmentOptions& options,
                         std::vector<Evidence>& evidence, SmoothingWorkspace& workspace) {
  couple(frame, options, workspace);
  const auto width = static_cast<std::size_t>(frame.width);
  workspace.line.resize(width);
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t start = 0; start < evidence.size(); start += width) {
      alongRow(&workspace.left[start], &evidence[start], width, workspace.line);
    }
    alongColumns(workspace.above, width, evidence, workspace);
  }
}

float beliefOf(const Evidence& sums) {
  return std::clamp(sums.value / (sums.weight + kDoubt), -1.0f, 1.0f);
}

bool isKnown(const Evidence& sums) { return sums.weight > kDoubt; }

}  // namespace hmcdyn::internal

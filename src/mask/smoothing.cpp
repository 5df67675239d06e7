// SPDX-License-Identifier: BSD-3-Clause
#include "mask/smoothing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace hmcdyn::internal {
namespace {

constexpr int kRounds = 2;      // one leaves stripes along rows and columns
constexpr float kDoubt = 0.5f;  // weight that draws a belief of little evidence to 0

Evidence operator*(float factor, const Evidence& e) {
  return {factor * e.value, factor * e.weight};
}
Evidence operator+(const Evidence& a, const Evidence& b) {
  return {a.value + b.value, a.weight + b.weight};
}
Evidence operator-(const Evidence& a, const Evidence& b) {
  return {a.value - b.value, a.weight - b.weight};
}

/// Several rows at once: each step waits for the one before, but not for those of other rows.
template <std::size_t kRows>
void alongRows(const float* left, Evidence* rows, std::size_t width, std::vector<Evidence>& own) {
  std::copy(rows, rows + kRows * width, own.begin());
  for (std::size_t x = 1; x < width; ++x) {
    for (std::size_t i = x; i < kRows * width; i += width) {
      rows[i] = rows[i] + left[i] * rows[i - 1];
    }
  }
  std::array<Evidence, kRows> back{};
  for (std::size_t x = width; x-- > 0;) {
    for (std::size_t k = 0; k < kRows; ++k) {
      const std::size_t i = k * width + x;
      const Evidence from_right = x + 1 < width ? left[i + 1] * back[k] : Evidence{};
      rows[i] = rows[i] + from_right;
      back[k] = own[i] + from_right;
    }
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

void spreadAlongSurfaces(const Couplings& couplings, int image_width,
                         std::vector<Evidence>& evidence, SmoothingWorkspace& workspace) {
  const auto width = static_cast<std::size_t>(image_width);
  constexpr std::size_t kTogether = 4;
  workspace.lines.resize(kTogether * width);
  for (int round = 0; round < kRounds; ++round) {
    std::size_t start = 0;
    for (; start + kTogether * width <= evidence.size(); start += kTogether * width) {
      alongRows<kTogether>(&couplings.left[start], &evidence[start], width, workspace.lines);
    }
    for (; start < evidence.size(); start += width) {
      alongRows<1>(&couplings.left[start], &evidence[start], width, workspace.lines);
    }
    alongColumns(couplings.above, width, evidence, workspace);
  }
}

float beliefOf(const Evidence& sums) {
  return std::clamp(sums.value / (sums.weight + kDoubt), -1.0f, 1.0f);
}

bool isKnown(const Evidence& sums) { return sums.weight > kDoubt; }

}  // namespace hmcdyn::internal

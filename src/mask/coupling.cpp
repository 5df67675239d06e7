// SPDX-License-Identifier: BSD-3-Clause
#include "mask/coupling.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace hmcdyn::internal {
namespace {

constexpr float kThroughHoles = 0.3f;  // share of the coupling that is left where depth is missing

/// Of pixels with those before them, a column or a row earlier.
void coupleRow(const float* here, const float* before, int count, float most, float depth_step,
               float* to) {
  for (int x = 0; x < count; ++x) {
    const float a = here[x];
    const float b = before[x];
    const float steps = (a - b) / (depth_step * std::min(a, b) + 0.002f);
    const float squared = steps * steps;
    const float on_surface = most / (1.0f + squared * squared);
    to[x] = allOf(a > 0.0f, b > 0.0f) ? on_surface : most * kThroughHoles;
  }
}

void coupleAtDepthEdges(const SmallFrame& frame, const SegmentModel& model, Couplings& couplings) {
  const float most = std::exp(-std::sqrt(2.0f) / model.reach);  // Gastal and Oliveira, eq. 21
  couplings.left.assign(frame.size(), 0.0f);
  couplings.above.assign(frame.size(), 0.0f);
  for (int y = 0; y < frame.height; ++y) {
    const std::size_t start = frame.index(y, 0);
    const float* depth = frame.depth.data() + start;
    coupleRow(depth + 1, depth, frame.width - 1, most, model.depth_step,
              couplings.left.data() + start + 1);
    if (y > 0) {
      coupleRow(depth, depth - frame.width, frame.width, most, model.depth_step,
                couplings.above.data() + start);
    }
  }
}

/// The crease that parts: by so much farther (m) than the chord between its neighbours, at depth z.
struct CreaseDepth {
  float offset = 0.0f;
  float quadratic = 0.0f;
  float at(float z) const { return offset + quadratic * z * z; }
};

CreaseDepth creaseDepth(const MaskModel& model) {
  // the middle has the noise of one depth, the chord that of the mean of two
  const float sigmas = model.segment.crease_gate * std::sqrt(1.5f);
  const DepthErrorModel& error = model.options.depth_error;
  return {model.segment.crease + sigmas * error.noise_floor, sigmas * error.noise_quadratic};
}

/// 1 / depth is linear along a plane's image, so that it sags nowhere.
/// @param step to the neighbours that span the chord. @return 0 .. 1, of the coupling that is left.
void wholeRow(const float* depth, const float* inverse, std::ptrdiff_t step, int count,
              const CreaseDepth& crease, float* whole) {
  constexpr float kSameThing = 0.06f;  // farther neighbours (share of the depth) are of another
  for (int x = 0; x < count; ++x) {
    const float before = inverse[x - step];
    const float here = inverse[x];
    const float after = inverse[x + step];
    const float z = depth[x];
    const float sag = 0.5f * (before + after - 2.0f * here) * z * z;
    const float creases = std::max(0.0f, sag) / crease.at(z);
    const float squared = creases * creases;
    const float near_before = std::abs(depth[x - step] - z);
    const float near_after = std::abs(depth[x + step] - z);
    const bool is_measured = allOf(before > 0.0f, here > 0.0f, after > 0.0f,
                                   near_before <= kSameThing * z, near_after <= kSameThing * z);
    whole[x] = is_measured ? 1.0f / (1.0f + squared * squared) : 1.0f;
  }
}

/// A pixel in a crease parts from both its neighbours in that direction.
void partAtCreases(const SmallFrame& frame, const MaskModel& model, Couplings& couplings) {
  constexpr int kChord = 3;  // reduced pixels from the middle to each end
  const CreaseDepth crease = creaseDepth(model);
  couplings.inverse_depth.resize(frame.size());
  for (std::size_t i = 0; i < frame.size(); ++i) {
    const float z = frame.depth[i];
    couplings.inverse_depth[i] = z > 0.0f ? 1.0f / z : 0.0f;
  }
  couplings.whole.resize(static_cast<std::size_t>(frame.width));
  float* whole = couplings.whole.data();
  for (int y = 0; y < frame.height; ++y) {
    const std::size_t start = frame.index(y, 0);
    const float* depth = frame.depth.data() + start;
    const float* inverse = couplings.inverse_depth.data() + start;
    const int inside = frame.width - 2 * kChord;
    wholeRow(depth + kChord, inverse + kChord, kChord, inside, crease, whole);
    float* left = couplings.left.data() + start + kChord;
    for (int x = 0; x < inside; ++x) {
      left[x] *= whole[x];
    }
    for (int x = 0; x < inside; ++x) {
      left[x + 1] *= whole[x];
    }
    if (y < kChord || y + kChord >= frame.height) {
      continue;
    }
    wholeRow(depth, inverse, std::ptrdiff_t{kChord} * frame.width, frame.width, crease, whole);
    float* above = couplings.above.data() + start;
    float* below = above + frame.width;
    for (int x = 0; x < frame.width; ++x) {
      above[x] *= whole[x];
      below[x] *= whole[x];
    }
  }
}

}  // namespace

Couplings coupleNeighbours(const SmallFrame& frame, const MaskModel& model, bool with_creases,
                           Couplings reuse) {
  Couplings couplings = std::move(reuse);
  coupleAtDepthEdges(frame, model.segment, couplings);
  if (with_creases) {
    partAtCreases(frame, model, couplings);
  }
  return couplings;
}

}  // namespace hmcdyn::internal

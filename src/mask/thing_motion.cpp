// SPDX-License-Identifier: BSD-3-Clause
#include "mask/thing_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace hmcdyn::internal {
namespace {

constexpr std::size_t kSamples = 120;
constexpr int kReach = 12;  // reduced pixels: 1.5 m/s across at 1.5 m in 0.1 s
constexpr int kCoarse = 2;  // first step of the search
constexpr std::size_t kShifts = 2 * (kReach + 1) + 1;  // the finest step goes one beyond
constexpr int kMostDifference = 40;                    // gray levels: more is not more wrong
constexpr float kLeastRelief = 2.0f;  // gray levels by which the best place beats the others
constexpr float kDepthGate = 0.25f;   // (m) that a depth may change in the time between

struct Sample {
  StaticPlace place;
  int gray = 0;
};

/// Pixels of a thing, and where they fall in the earlier image when all are moved.
struct Samples {
  /// A pixel's column or the first pixel of its row, for each of the shifts; -1 outside.
  using Moved = std::array<std::array<int, kSamples>, kShifts>;

  std::array<Sample, kSamples> items{};
  std::size_t count = 0;
  Moved column{};
  Moved row_start{};
};

/// Index of a shift by du or dv in Samples::Moved.
std::size_t shiftIndex(int pixels) { return static_cast<std::size_t>(pixels + kReach + 1); }

Samples samplesOf(const ThingsInput& in, const SmallFrame& earlier, const std::uint32_t* begin,
                  const std::uint32_t* end) {
  const RelativePose motion = relativePose(earlier.camera_from_world, in.frame.camera_from_world);
  Samples samples;
  const auto pixels = static_cast<std::size_t>(end - begin);
  for (std::size_t k = 0; k < kSamples && k < pixels; ++k) {
    const std::uint32_t pixel = begin[k * pixels / std::min(kSamples, pixels)];
    const StaticPlace place = staticPlace(pixel, in.frame, in.camera, motion);
    if (place.depth > 0.0f) {
      samples.items[samples.count++] = {place, in.frame.gray[pixel]};
    }
  }
  const auto moved = [](float at, int by, int size) {
    const float to = at + static_cast<float>(by);
    return to >= 0.0f && to < static_cast<float>(size) ? static_cast<int>(to) : -1;
  };
  for (int by = -kReach - 1; by <= kReach + 1; ++by) {
    for (std::size_t k = 0; k < samples.count; ++k) {
      const StaticPlace& place = samples.items[k].place;
      const int row = moved(place.v, by, earlier.height);
      samples.column[shiftIndex(by)][k] = moved(place.u, by, earlier.width);
      samples.row_start[shiftIndex(by)][k] = row < 0 ? -1 : row * earlier.width;
    }
  }
  return samples;
}

/// Mean absolute gray difference when all samples are moved by (du, dv) in the earlier image.
float costOf(const Samples& samples, const SmallFrame& earlier, int du, int dv) {
  const std::array<int, kSamples>& columns = samples.column[shiftIndex(du)];
  const std::array<int, kSamples>& row_starts = samples.row_start[shiftIndex(dv)];
  int sum = 0;
  for (std::size_t k = 0; k < samples.count; ++k) {
    const bool seen = allOf(columns[k] >= 0, row_starts[k] >= 0);
    const auto at = static_cast<std::size_t>(seen ? row_starts[k] + columns[k] : 0);
    const Sample& sample = samples.items[k];
    const float z = earlier.depth[at];
    const bool other_surface = allOf(z > 0.0f, std::abs(z - sample.place.depth) > kDepthGate);
    const int difference = std::min(kMostDifference, std::abs(sample.gray - earlier.gray[at]));
    const int cost = other_surface ? kMostDifference : difference;
    sum += seen ? cost : kMostDifference / 2;  // not seen: neither right nor wrong
  }
  return static_cast<float>(sum) / static_cast<float>(samples.count);
}

struct Shift {
  int du = 0;
  int dv = 0;
  float cost = 0.0f;
  float mean_cost = 0.0f;  ///< Of all places that were tried.
};

Shift bestShift(const Samples& samples, const SmallFrame& earlier) {
  Shift best{0, 0, costOf(samples, earlier, 0, 0), 0.0f};
  float sum = 0.0f;
  int tried = 0;
  const auto attempt = [&](int du, int dv) {
    const float cost = costOf(samples, earlier, du, dv);
    sum += cost;
    ++tried;
    if (cost < best.cost) {
      best.du = du;
      best.dv = dv;
      best.cost = cost;
    }
  };
  for (int dv = -kReach; dv <= kReach; dv += kCoarse) {
    for (int du = -kReach; du <= kReach; du += kCoarse) {
      attempt(du, dv);
    }
  }
  best.mean_cost = sum / static_cast<float>(tried);
  const Shift coarse = best;
  for (int dv = -1; dv <= 1; ++dv) {
    for (int du = -1; du <= 1; ++du) {
      attempt(coarse.du + du, coarse.dv + dv);
    }
  }
  return best;
}

/// Where a parabola through three costs is lowest, -0.5 .. 0.5.
float refine(float before, float here, float after) {
  const float curvature = before - 2.0f * here + after;
  return curvature > 1e-3f ? std::clamp(0.5f * (before - after) / curvature, -0.5f, 0.5f) : 0.0f;
}

/// Mean step of the samples in the earlier camera's frame (m).
bool meanStep(const Samples& samples, const SmallFrame& earlier, const SmallCamera& camera,
              const Shift& shift, std::array<float, 3>& step) {
  const float fraction_u = refine(costOf(samples, earlier, shift.du - 1, shift.dv), shift.cost,
                                  costOf(samples, earlier, shift.du + 1, shift.dv));
  const float fraction_v = refine(costOf(samples, earlier, shift.du, shift.dv - 1), shift.cost,
                                  costOf(samples, earlier, shift.du, shift.dv + 1));
  std::size_t count = 0;
  step = {0, 0, 0};
  for (std::size_t k = 0; k < samples.count; ++k) {
    const StaticPlace& place = samples.items[k].place;
    const float u = place.u + static_cast<float>(shift.du);
    const float v = place.v + static_cast<float>(shift.dv);
    if (!(u >= 0.0f && v >= 0.0f && u < static_cast<float>(earlier.width) &&
          v < static_cast<float>(earlier.height))) {
      continue;
    }
    const float z =
        earlier.depth[static_cast<std::size_t>(v) * static_cast<std::size_t>(earlier.width) +
                      static_cast<std::size_t>(u)];
    if (!(z > 0.0f) || std::abs(z - place.depth) > kDepthGate) {
      continue;
    }
    const float ray_u = (u + fraction_u - 0.5f - camera.cx) / camera.fx;
    const float ray_v = (v + fraction_v - 0.5f - camera.cy) / camera.fy;
    step[0] += (place.u - 0.5f - camera.cx) / camera.fx * place.depth - ray_u * z;
    step[1] += (place.v - 0.5f - camera.cy) / camera.fy * place.depth - ray_v * z;
    step[2] += place.depth - z;
    ++count;
  }
  for (float& component : step) {
    component /= static_cast<float>(std::max<std::size_t>(count, 1));
  }
  return count * 4 >= samples.count;
}

}  // namespace

ThingMotion motionOfThing(const ThingsInput& in, const std::uint32_t* begin,
                          const std::uint32_t* end) {
  const SmallFrame& earlier = *in.earlier[in.earlier.size() > 1 ? 1 : 0];
  const double age = in.frame.timestamp - earlier.timestamp;
  ThingMotion result;
  if (in.frame.gray.empty() || earlier.gray.empty() || age <= 0.0) {
    return result;
  }
  const Samples samples = samplesOf(in, earlier, begin, end);
  if (samples.count < kSamples / 4) {
    return result;
  }
  const Shift shift = bestShift(samples, earlier);
  std::array<float, 3> step{};
  if (shift.mean_cost - shift.cost < kLeastRelief || std::abs(shift.du) > kReach - 1 ||
      std::abs(shift.dv) > kReach - 1 || !meanStep(samples, earlier, in.camera, shift, step)) {
    return result;
  }
  result.found = true;
  const PlainMatrix<3, 4>& pose = earlier.camera_from_world.matrix;
  for (int i = 0; i < 3; ++i) {
    double sum = 0.0;
    for (int k = 0; k < 3; ++k) {
      sum += pose(k, i) * static_cast<double>(step[static_cast<std::size_t>(k)]);  // transposed
    }
    result.velocity[static_cast<std::size_t>(i)] = static_cast<float>(sum / age);
  }
  return result;
}

}  // namespace hmcdyn::internal

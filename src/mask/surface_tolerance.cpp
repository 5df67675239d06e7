// SPDX-License-Identifier: BSD-3-Clause
#include "mask/surface_tolerance.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace hmcdyn::internal {
namespace {

constexpr std::uint32_t kErrorStep = 13;    // every so many pixels are asked
constexpr std::size_t kFewestErrors = 100;  // that answer
constexpr float kLargestError = 0.15f;      // (m): more is another surface
constexpr float kEdgeOfSurface = 0.05f;     // 3 x 3 depths that differ by more (share) are none
// The quantile that speaks, since up to half of the surfaces may be others than then; and where it
// lies in a normal distribution of standard deviation 1 (of its absolute value).
constexpr float kErrorQuantile = 0.35f;
constexpr float kErrorQuantileOfNormal = 0.4538f;
constexpr float kLeastNoise = 0.4f;  // factors: less is luck, ...
constexpr float kMostNoise = 4.0f;   // ... more a motion that is wrong

}  // namespace

float measuredNoise(const SmallFrame& frame, const SmallFrame& earlier, const SmallCamera& camera,
                    const RelativePose& motion, const MaskModel& model,
                    std::vector<float>& errors) {
  errors.clear();
  const DepthErrorModel& noise = model.options.depth_error;
  const auto pixels = static_cast<std::uint32_t>(frame.size());
  for (std::uint32_t i = 0; i < pixels; i += kErrorStep) {
    const StaticPlace place = staticPlace(i, frame, camera, motion);
    const std::int32_t pixel = pixelAround(place.u, place.v, place.depth <= model.options.max_depth,
                                           earlier.width, earlier.height);
    if (pixel < 0) {
      continue;
    }
    const auto there = static_cast<std::size_t>(pixel);
    const float z = earlier.depth[there];
    const MaskCell& cell = earlier.cells[there];
    const float error = std::abs(z - place.depth);
    if (z > 0.0f && cell.belief <= 0.0f && cell.farthest - cell.nearest <= kEdgeOfSurface * z &&
        error <= kLargestError) {
      errors.push_back(error / depthNoise(z, noise));
    }
  }
  if (errors.size() < kFewestErrors) {
    return 1.0f;
  }
  const auto at = errors.begin() +
                  static_cast<std::ptrdiff_t>(kErrorQuantile * static_cast<float>(errors.size()));
  std::nth_element(errors.begin(), at, errors.end());
  const float factor = *at / (kErrorQuantileOfNormal * std::sqrt(2.0f));  // both depths are noisy
  return std::clamp(factor, kLeastNoise, kMostNoise);
}

SurfaceTolerance surfaceTolerance(const MaskModel& model, float noise) {
  const float sigmas = model.depth.gate * noise * std::sqrt(2.0f);
  const DepthErrorModel& error = model.options.depth_error;
  return {model.depth.slack + sigmas * error.noise_floor, error.systematic_linear,
          sigmas * error.noise_quadratic + error.systematic_quadratic};
}

}  // namespace hmcdyn::internal

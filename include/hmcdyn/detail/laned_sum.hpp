// SPDX-License-Identifier: BSD-3-Clause
// Sums over arrays with gaps, which vectorise and are the same whatever the processor.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>

#include <hmcdyn/detail/planar_points.hpp>
#include <hmcdyn/types.hpp>

namespace hmcdyn::detail {

/// Sum and count of some values, taken in kLanes sums, which vectorises.
struct LanedSum {
  std::array<double, kLanes> sum{};
  std::array<float, kLanes> count{};  ///< Whole numbers, exact up to 2^24 a lane.

  double total() const noexcept { return std::accumulate(sum.begin(), sum.end(), 0.0); }
  std::size_t number() const noexcept {
    return static_cast<std::size_t>(std::accumulate(count.begin(), count.end(), 0.0));
  }
};

/// Adds `value(x)` of each of kLanes numbers where `counts(x)`, which a NaN never does.
template <class Counts, class Value>
void addLanes(const float* x, Counts&& counts, Value&& value, LanedSum& result) {
  std::array<float, kLanes> used;   // NOLINT(cppcoreguidelines-pro-type-member-init): written next
  std::array<float, kLanes> count;  // NOLINT(cppcoreguidelines-pro-type-member-init)
  HMCDYN_KEEP_LOOP
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    used[lane] = counts(x[lane]) ? x[lane] : 0.0f;
    count[lane] = counts(x[lane]) ? 1.0f : 0.0f;
  }
  HMCDYN_KEEP_LOOP
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    result.sum[lane] += static_cast<double>(count[lane]) * value(static_cast<double>(used[lane]));
    result.count[lane] += count[lane];
  }
}

template <class Counts, class Value>
LanedSum sumOf(Span<const float> x, Counts&& counts, Value&& value) {
  LanedSum result;
  const std::size_t in_lanes = x.size() / kLanes * kLanes;
  for (std::size_t i = 0; i < in_lanes; i += kLanes) {
    addLanes(x.data() + i, counts, value, result);
  }
  std::array<float, kLanes> rest{};
  rest.fill(kNaN);
  std::copy(x.begin() + in_lanes, x.end(), rest.begin());
  addLanes(rest.data(), counts, value, result);
  return result;
}

}  // namespace hmcdyn::detail

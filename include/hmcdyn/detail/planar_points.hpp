// SPDX-License-Identifier: BSD-3-Clause
// Points in the plane as the fast clustering backends take them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <hmcdyn/types.hpp>

namespace hmcdyn::detail {

/// Points handled at a time: inner loops of this fixed length are vectorised even at -O2.
inline constexpr std::size_t kLanes = 8;

/// N points, structure of arrays. A point with a coordinate that is not finite has both NaN, and so
/// is nobody's neighbour; at least kLanes such points follow the last one, up to a multiple of
/// kLanes.
struct PlanarPoints {
  std::vector<float> x;
  std::vector<float> y;
  std::size_t size = 0;

  std::size_t padded() const noexcept { return x.size(); }
  void resize(std::size_t n) {
    size = n;
    x.resize((n / kLanes + 2) * kLanes);
    y.resize(x.size());
    for (std::size_t i = n; i < x.size(); ++i) {
      x[i] = kNaN;
      y[i] = kNaN;
    }
  }
};

/// The neighbourhood of eq. 6 for p = 2 in the plane; agrees with MinkowskiBall to the last bit.
struct Disc {
  float squared_radius;

  explicit Disc(float radius) : squared_radius(radius * radius), limit_(2.0f * squared_radius) {}

  /// Squared distance; a square beyond the radius may come out smaller, but beyond the radius. With
  /// the limit in between, no compiler fuses product and sum, which would round differently.
  float power(float dx, float dy) const noexcept { return bounded(dx * dx) + bounded(dy * dy); }
  bool contains(float dx, float dy) const noexcept { return power(dx, dy) <= squared_radius; }

 private:
  float bounded(float square) const noexcept { return square < limit_ ? square : limit_; }

  float limit_;
};

}  // namespace hmcdyn::detail

// SPDX-License-Identifier: BSD-3-Clause
// Points in the plane as the fast clustering backends take them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#if defined(__AVX__)
#include <immintrin.h>
#endif

#include <hmcdyn/detail/bits.hpp>
#include <hmcdyn/types.hpp>

namespace hmcdyn::detail {

/// Points handled at a time: inner loops of this fixed length are vectorised even at -O2.
inline constexpr std::size_t kLanes = 8;

/// N points, structure of arrays. A point with a coordinate that is not finite has both NaN, and so
/// is nobody's neighbour; such points follow the last one up to a multiple of kBlock.
struct PlanarPoints {
  std::vector<float> x;
  std::vector<float> y;
  std::size_t size = 0;

  std::size_t padded() const noexcept { return x.size(); }
  void resize(std::size_t n) {
    size = n;
    x.resize((n / kBlock + 1) * kBlock);
    y.resize(x.size());
    for (std::size_t i = n; i < x.size(); ++i) {
      x[i] = kNaN;
      y[i] = kNaN;
    }
  }
};

/// The neighbourhood of eq. 6 for p = 2 in the plane; agrees with MinkowskiBall to the last bit.
class Disc {
 public:
  explicit Disc(float radius) : squared_radius_(radius * radius), limit_(2.0f * squared_radius_) {}

  float squaredRadius() const noexcept { return squared_radius_; }

  /// Squared distance; a square beyond the radius may come out smaller, but beyond the radius. With
  /// the limit in between, no compiler fuses product and sum, which would round differently.
  float power(float dx, float dy) const noexcept { return bounded(dx * dx) + bounded(dy * dy); }
  bool contains(float dx, float dy) const noexcept { return power(dx, dy) <= squared_radius_; }

  /// Which of a block's points are neighbours of (px, py), a bit a point.
  std::uint32_t neighboursInBlock(const float* x, const float* y, float px,
                                  float py) const noexcept {
#if defined(__AVX__)
    const __m256 limit = _mm256_set1_ps(limit_);
    const __m256 squared_radius = _mm256_set1_ps(squared_radius_);
    std::uint32_t bits = 0;
    for (std::size_t lanes = 0; lanes < kBlock; lanes += kLanes) {
      const __m256 dx = _mm256_sub_ps(_mm256_loadu_ps(x + lanes), _mm256_set1_ps(px));
      const __m256 dy = _mm256_sub_ps(_mm256_loadu_ps(y + lanes), _mm256_set1_ps(py));
      const __m256 sum = _mm256_add_ps(_mm256_min_ps(_mm256_mul_ps(dx, dx), limit),
                                       _mm256_min_ps(_mm256_mul_ps(dy, dy), limit));
      const int mask = _mm256_movemask_ps(_mm256_cmp_ps(sum, squared_radius, _CMP_LE_OQ));
      bits |= static_cast<std::uint32_t>(mask) << lanes;
    }
    return bits;
#else
    return neighboursInBlockPortably(x, y, px, py);
#endif
  }

  /// The same in plain C++.
  std::uint32_t neighboursInBlockPortably(const float* x, const float* y, float px,
                                          float py) const noexcept {
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < kBlock; ++i) {
      // A mask, not a choice: GCC would load the bit under a branch, and not vectorise.
      bits |= (0U - (contains(x[i] - px, y[i] - py) ? 1U : 0U)) & kBits.bit[i];
    }
    return bits;
  }

 private:
  float bounded(float square) const noexcept { return square < limit_ ? square : limit_; }

  float squared_radius_;
  float limit_;
};

}  // namespace hmcdyn::detail

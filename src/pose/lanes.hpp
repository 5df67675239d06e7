// SPDX-License-Identifier: BSD-3-Clause
// Several doubles in one vector register, by the vector types of GCC and Clang: the width follows
// what the compiler was allowed to use, the source stays arithmetic. Elsewhere, or where
// HMCDYN_SCALAR_LANES asks for it, one plain double.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstring>

#if defined(__GNUC__) && !defined(HMCDYN_SCALAR_LANES)
#define HMCDYN_VECTOR_LANES 1
#else
#define HMCDYN_VECTOR_LANES 0
#endif

namespace hmcdyn::detail {

#if HMCDYN_VECTOR_LANES
#ifdef __AVX__
constexpr std::size_t kLanes = 4;
#else
constexpr std::size_t kLanes = 2;
#endif
using Lanes __attribute__((vector_size(kLanes * sizeof(double)))) = double;
#else
constexpr std::size_t kLanes = 1;
using Lanes = double;
#endif

inline Lanes loadLanes(const double* values) {
  Lanes lanes;
  std::memcpy(&lanes, values, sizeof(lanes));
  return lanes;
}

inline void storeLanes(const Lanes& lanes, double* values) {
  std::memcpy(values, &lanes, sizeof(lanes));
}

inline Lanes smaller(const Lanes& a, const Lanes& b) { return a < b ? a : b; }
inline Lanes larger(const Lanes& a, const Lanes& b) { return a > b ? a : b; }

inline Lanes squareRoot(const Lanes& a) {
#if HMCDYN_VECTOR_LANES
  Lanes root{};
  for (std::size_t k = 0; k < kLanes; ++k) {
    root[k] = std::sqrt(a[k]);
  }
  return root;
#else
  return std::sqrt(a);
#endif
}

/// The lanes' sum.
inline double total(const Lanes& a) {
#if HMCDYN_VECTOR_LANES
  double sum = a[0] + a[kLanes / 2];
  for (std::size_t k = 1; k < kLanes / 2; ++k) {
    sum += a[k] + a[k + kLanes / 2];
  }
  return sum;
#else
  return a;
#endif
}

}  // namespace hmcdyn::detail

// SPDX-License-Identifier: BSD-3-Clause
// What C++20 has in <bit>.
#pragma once

#include <cstdint>

namespace hmcdyn::detail {

/// Number of ones. Compilers know the pattern and use the processor's instruction where there is
/// one.
inline std::uint32_t countOnes(std::uint64_t bits) noexcept {
  bits = bits - ((bits >> 1) & 0x5555555555555555U);
  bits = (bits & 0x3333333333333333U) + ((bits >> 2) & 0x3333333333333333U);
  bits = (bits + (bits >> 4)) & 0x0f0f0f0f0f0f0f0fU;
  return static_cast<std::uint32_t>((bits * 0x0101010101010101U) >> 56);
}

/// Position of the lowest one; `bits` must not be 0.
inline std::uint32_t lowestOne(std::uint64_t bits) noexcept {
#if defined(__GNUC__) || defined(__clang__)
  return static_cast<std::uint32_t>(__builtin_ctzll(bits));
#else
  return countOnes((bits & (~bits + 1)) - 1);
#endif
}

}  // namespace hmcdyn::detail

// SPDX-License-Identifier: BSD-3-Clause
// Sets of points as words of bits, and what C++20 has in <bit>.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

// In front of a short loop that is to be vectorised: GCC would unroll it before it looks.
#if defined(__GNUC__) && !defined(__clang__)
#define HMCDYN_KEEP_LOOP _Pragma("GCC unroll 1")
#else
#define HMCDYN_KEEP_LOOP
#endif

namespace hmcdyn::detail {

/// Points handled as one word of bits.
inline constexpr std::size_t kBlock = 32;

/// Bit i at index i: loops over it vectorise where shifts by the index do not.
struct BitTable {
  std::array<std::uint32_t, kBlock> bit{};
  constexpr BitTable() {
    for (std::size_t i = 0; i < kBlock; ++i) {
      bit[i] = std::uint32_t{1} << i;
    }
  }
};
inline constexpr BitTable kBits;

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

/// Position of the highest one; `bits` must not be 0.
inline std::uint32_t highestOne(std::uint64_t bits) noexcept {
#if defined(__GNUC__) || defined(__clang__)
  return 63U - static_cast<std::uint32_t>(__builtin_clzll(bits));
#else
  for (std::uint32_t shift = 1; shift < 64; shift *= 2) {
    bits |= bits >> shift;
  }
  return countOnes(bits) - 1;
#endif
}

/// Writes the transpose of a 32 x 32 matrix of bits, a word a row. Each pass exchanges the rows'
/// highest bit of index with one of the columns' and rotates the rows' index, so that all passes
/// are one loop, which vectorises.
inline void transpose32(const std::uint32_t* from, std::uint32_t* to) noexcept {
  // NOLINTBEGIN(cppcoreguidelines-pro-type-member-init): all of it is written before it is read
  std::array<std::uint32_t, 32> in;
  std::array<std::uint32_t, 32> out;
  // NOLINTEND(cppcoreguidelines-pro-type-member-init)
  std::copy(from, from + 32, in.begin());
  std::uint32_t mask = 0x0000ffffU;
  for (std::uint32_t shift = 16; shift > 0; shift /= 2) {
    HMCDYN_KEEP_LOOP
    for (std::size_t k = 0; k < 16; ++k) {
      const std::uint32_t swapped = ((in[k] >> shift) ^ in[k + 16]) & mask;
      out[2 * k] = in[k] ^ (swapped << shift);
      out[2 * k + 1] = in[k + 16] ^ swapped;
    }
    in = out;
    mask ^= mask << (shift / 2);
  }
  std::copy(in.begin(), in.end(), to);
}

}  // namespace hmcdyn::detail

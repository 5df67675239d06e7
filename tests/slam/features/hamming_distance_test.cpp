// SPDX-License-Identifier: BSD-3-Clause
#include "slam/features/hamming_distance.hpp"

#include <array>
#include <bitset>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace hmcdyn::slam {
namespace {

using Bytes = std::array<std::uint8_t, kDescriptorBytes>;

TEST(HammingDistance, CountsByHand) {
  Bytes a{};
  Bytes b{};
  EXPECT_EQ(hammingDistance(a.data(), b.data()), 0);
  b[0] = 0x80;   // 1 bit
  b[9] = 0x0f;   // 4
  b[31] = 0xff;  // 8
  EXPECT_EQ(hammingDistance(a.data(), b.data()), 13);
  a[31] = 0xf0;  // leaves 4 of the 8
  EXPECT_EQ(hammingDistance(a.data(), b.data()), 9);
}

TEST(HammingDistance, AllBitsMakeTheLargestDistance) {
  Bytes a{};
  Bytes b{};
  b.fill(0xff);
  EXPECT_EQ(hammingDistance(a.data(), b.data()), 256);
}

TEST(HammingDistance, AgreesWithBitByBitCountingAtAnyAddress) {
  std::mt19937 random(7);
  std::vector<std::uint8_t> bytes(2 * kDescriptorBytes + 16);
  for (int trial = 0; trial < 200; ++trial) {
    for (std::uint8_t& byte : bytes) {
      byte = static_cast<std::uint8_t>(random());
    }
    const std::uint8_t* a = bytes.data() + trial % 7;  // not aligned
    const std::uint8_t* b = bytes.data() + kDescriptorBytes + 8 + trial % 5;
    std::size_t expected = 0;
    for (int i = 0; i < kDescriptorBytes; ++i) {
      expected += std::bitset<8>(static_cast<unsigned>(a[i] ^ b[i])).count();
    }
    ASSERT_EQ(hammingDistance(a, b), static_cast<int>(expected));
    ASSERT_EQ(hammingDistance(b, a), static_cast<int>(expected));
  }
}

}  // namespace
}  // namespace hmcdyn::slam

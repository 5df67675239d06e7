// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

namespace hmcdyn::test {

/// Random numbers that are the same with every standard library: the distributions of <random> are
/// not, its engines are.
class Random {
 public:
  explicit Random(std::uint32_t seed) : engine_(seed) {}

  /// In [low, high).
  double uniform(double low, double high) {
    constexpr double kRange = 4294967296.0;
    return low + (high - low) * (static_cast<double>(engine_()) / kRange);
  }

  float uniformFloat(double low, double high) { return static_cast<float>(uniform(low, high)); }

  /// In [low, high], both included.
  int integer(int low, int high) {
    return low + static_cast<int>(engine_() % static_cast<std::uint32_t>(high - low + 1));
  }

  bool chance(double probability) { return uniform(0.0, 1.0) < probability; }

  /// Normal, by Box and Muller.
  double normal(double sigma) {
    constexpr double kTwoPi = 6.283185307179586;
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform(0.0, 1.0)));
    return sigma * radius * std::cos(uniform(0.0, kTwoPi));
  }

  /// A random order of 0 .. n - 1.
  std::vector<std::size_t> permutation(std::size_t n) {
    std::vector<std::size_t> order(n);
    std::iota(order.begin(), order.end(), std::size_t{0});
    for (std::size_t i = n; i > 1; --i) {
      std::swap(order[i - 1], order[engine_() % i]);
    }
    return order;
  }

 private:
  std::mt19937 engine_;
};

}  // namespace hmcdyn::test

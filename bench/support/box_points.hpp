// SPDX-License-Identifier: BSD-3-Clause
// Points of detection boxes as real ones give them.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include <hmcdyn/steps/clustering.hpp>

namespace hmcdyn::bench {

/// Depths (m) and distances (px) of one box.
struct BoxPoints {
  std::vector<float> depth;
  std::vector<float> distance;
};

/// Random numbers that are the same with every standard library.
class Random {
 public:
  explicit Random(std::uint32_t seed) : engine_(seed) {}

  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_()) / 4294967296.0);
  }
  double normal(double mean, double sigma) {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform(0.0, 1.0)));
    return mean + sigma * radius * std::cos(uniform(0.0, 6.283185307179586));
  }

 private:
  std::mt19937 engine_;
};

/// 60 % a person somewhere at 1.5-2.5 m (s.d. 0.1 m) with 1-5 px, 35 % background at 3-4 m with
/// 0-0.5 px, 5 % outliers at 0.5-8 m with 0-20 px, in random order.
inline BoxPoints makeBoxPoints(std::size_t n, Random& random) {
  BoxPoints points;
  const double person = random.uniform(1.5, 2.5);
  for (std::size_t i = 0; i < n; ++i) {
    const double kind = random.uniform(0.0, 1.0);
    double depth = random.uniform(3.0, 4.0);
    double distance = random.uniform(0.0, 0.5);
    if (kind < 0.6) {
      depth = random.normal(person, 0.1);
      distance = random.uniform(1.0, 5.0);
    } else if (kind >= 0.95) {
      depth = random.uniform(0.5, 8.0);
      distance = random.uniform(0.0, 20.0);
    }
    points.depth.push_back(static_cast<float>(depth));
    points.distance.push_back(static_cast<float>(distance));
  }
  return points;
}

/// Up to 1000 points one radius, in which a neighbourhood holds about 5 of 50 points and 100 of
/// 1000; beyond shrunk with their number, so that neighbourhoods stay at about 30 points.
inline ClusteringOptions clusteringOptionsFor(std::size_t n) {
  ClusteringOptions options;
  options.depth_scale = 1.0f;
  options.distance_scale = 0.05f;
  options.epsilon =
      n <= 1000 ? 0.07f : 0.07f * static_cast<float>(std::sqrt(300.0 / static_cast<double>(n)));
  options.min_points = 5;
  options.order = 2.0f;
  return options;
}

/// Different inputs to go round in: 256, so that the branch predictor does not learn them by heart;
/// fewer from 8000 points, which it cannot.
inline std::size_t inputsFor(std::size_t n) { return n <= 8000 ? 256 : n <= 200000 ? 8 : 2; }

inline std::vector<BoxPoints> makeInputs(std::size_t n) {
  Random random(static_cast<std::uint32_t>(n));
  std::vector<BoxPoints> inputs;
  for (std::size_t k = 0; k < inputsFor(n); ++k) {
    inputs.push_back(makeBoxPoints(n, random));
  }
  return inputs;
}

}  // namespace hmcdyn::bench

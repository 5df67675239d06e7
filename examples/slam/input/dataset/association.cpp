// SPDX-License-Identifier: BSD-3-Clause
#include "slam/input/dataset/association.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>
#include <tuple>

namespace hmcdyn::slam {
namespace {

struct Candidate {
  double difference;  // s
  std::size_t a;
  std::size_t b;
};

std::vector<Candidate> candidatesWithin(const std::vector<double>& a, const std::vector<double>& b,
                                        double tolerance) {
  std::vector<std::size_t> b_order(b.size());
  std::iota(b_order.begin(), b_order.end(), std::size_t{0});
  std::sort(b_order.begin(), b_order.end(),
            [&](std::size_t left, std::size_t right) { return b[left] < b[right]; });

  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < a.size(); ++i) {
    // The test below decides; the search only skips what is clearly too early.
    const auto first = std::partition_point(b_order.begin(), b_order.end(),
                                            [&](std::size_t j) { return a[i] - b[j] > tolerance; });
    for (auto j = first; j != b_order.end() && b[*j] - a[i] <= tolerance; ++j) {
      candidates.push_back({std::abs(a[i] - b[*j]), i, *j});
    }
  }
  return candidates;
}

}  // namespace

std::vector<std::pair<std::size_t, std::size_t>> associate(const std::vector<double>& a,
                                                           const std::vector<double>& b,
                                                           double tolerance) {
  if (!(tolerance >= 0.0)) {
    throw std::invalid_argument("associate: tolerance is " + std::to_string(tolerance) +
                                " s; expected 0 or more");
  }
  std::vector<Candidate> candidates = candidatesWithin(a, b, tolerance);
  std::sort(candidates.begin(), candidates.end(),
            [](const Candidate& left, const Candidate& right) {
              return std::tie(left.difference, left.a, left.b) <
                     std::tie(right.difference, right.a, right.b);
            });

  std::vector<bool> a_taken(a.size(), false);
  std::vector<bool> b_taken(b.size(), false);
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (const Candidate& candidate : candidates) {
    if (!a_taken[candidate.a] && !b_taken[candidate.b]) {
      a_taken[candidate.a] = true;
      b_taken[candidate.b] = true;
      pairs.emplace_back(candidate.a, candidate.b);
    }
  }
  std::sort(pairs.begin(), pairs.end(), [&](const auto& left, const auto& right) {
    return std::tie(a[left.first], left.first) < std::tie(a[right.first], right.first);
  });
  return pairs;
}

}  // namespace hmcdyn::slam

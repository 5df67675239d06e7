// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/association.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include <fmt/format.h>

namespace hmcdyn::evaluate {
namespace {

struct Stamp {
  double time;
  std::size_t index;
};

bool isEarlier(const Stamp& a, const Stamp& b) {
  return a.time != b.time ? a.time < b.time : a.index < b.index;
}

std::vector<Stamp> sorted(Span<const double> times, double offset, const char* argument) {
  std::vector<Stamp> stamps;
  stamps.reserve(times.size());
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (!std::isfinite(times[i])) {
      throw std::invalid_argument(fmt::format("associate: {} holds {} at {}; expected finite times",
                                              argument, times[i], i));
    }
    stamps.push_back({times[i] + offset, i});
  }
  std::sort(stamps.begin(), stamps.end(), isEarlier);
  return stamps;
}

/// Ranks of a first and a second stamp in their sorted lists.
struct Candidate {
  double difference;
  std::size_t first;
  std::size_t second;
};

bool isPreferred(const Candidate& a, const Candidate& b) {
  if (a.difference != b.difference) {
    return a.difference < b.difference;
  }
  return a.first != b.first ? a.first < b.first : a.second < b.second;
}

std::vector<Candidate> findCandidates(const std::vector<Stamp>& first,
                                      const std::vector<Stamp>& second, double tolerance) {
  std::vector<Candidate> candidates;
  std::size_t window = 0;  // the earliest second stamp that this and later first stamps can reach
  for (std::size_t i = 0; i < first.size(); ++i) {
    while (window < second.size() && first[i].time - second[window].time >= tolerance) {
      ++window;
    }
    for (std::size_t j = window; j < second.size(); ++j) {
      const double difference = std::abs(first[i].time - second[j].time);
      if (difference >= tolerance) {
        break;
      }
      candidates.push_back({difference, i, j});
    }
  }
  std::sort(candidates.begin(), candidates.end(), isPreferred);
  return candidates;
}

}  // namespace

std::vector<IndexPair> associate(Span<const double> first, Span<const double> second,
                                 const AssociationOptions& options) {
  if (!(options.tolerance > 0.0)) {
    throw std::invalid_argument(
        fmt::format("associate: tolerance is {} s; expected more than 0", options.tolerance));
  }
  if (!std::isfinite(options.offset)) {
    throw std::invalid_argument(
        fmt::format("associate: offset is {} s; expected a finite time", options.offset));
  }
  const std::vector<Stamp> a = sorted(first, 0.0, "first");
  const std::vector<Stamp> b = sorted(second, options.offset, "second");

  constexpr std::size_t kFree = std::numeric_limits<std::size_t>::max();
  std::vector<std::size_t> partner(a.size(), kFree);
  std::vector<bool> taken(b.size(), false);
  for (const Candidate& candidate : findCandidates(a, b, options.tolerance)) {
    if (partner[candidate.first] == kFree && !taken[candidate.second]) {
      partner[candidate.first] = candidate.second;
      taken[candidate.second] = true;
    }
  }
  std::vector<IndexPair> pairs;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (partner[i] != kFree) {
      pairs.push_back({a[i].index, b[partner[i]].index});
    }
  }
  return pairs;
}

}  // namespace hmcdyn::evaluate

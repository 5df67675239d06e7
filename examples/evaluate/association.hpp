// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include <hmcdyn/span.hpp>

namespace hmcdyn::evaluate {

/// An element of a first list and its partner in a second list.
struct IndexPair {
  std::size_t first = 0;
  std::size_t second = 0;
};

inline bool operator==(const IndexPair& a, const IndexPair& b) noexcept {
  return a.first == b.first && a.second == b.second;
}

/// How time stamps of two lists may be paired.
struct AssociationOptions {
  double tolerance = 0.02;  ///< Largest time difference of a pair, itself excluded (s), > 0.
  double offset = 0.0;      ///< Added to the time stamps of the second list (s).
};

/// Pairs time stamps (s) one to one: over and over the two closest that are still free and nearer
/// than the tolerance, as TUM's associate.py does. Among equally close pairs the one with the
/// earlier first stamp goes first, then the one with the earlier second stamp, then the one with
/// the lower index. The lists need not be sorted and may be empty.
/// @return pairs in the order of the first list's stamps.
/// @throws std::invalid_argument when an option is out of range or a stamp is not finite.
std::vector<IndexPair> associate(Span<const double> first, Span<const double> second,
                                 const AssociationOptions& options = {});

}  // namespace hmcdyn::evaluate

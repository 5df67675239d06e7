// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace hmcdyn::slam {

/// One-to-one pairs of time stamps (s) that differ by at most the tolerance: the pair with the
/// smallest difference is taken first, equal differences in the order of a, then b, as the tools
/// of the TUM RGB-D benchmark (Sturm et al., IROS 2012) do.
/// @return pairs of indices into a and b, ordered by the time stamp in a.
/// @throws std::invalid_argument where the tolerance is negative or NaN.
std::vector<std::pair<std::size_t, std::size_t>> associate(const std::vector<double>& a,
                                                           const std::vector<double>& b,
                                                           double tolerance);

}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace hmcdyn::evaluate {

/// Tracking rate (%), eq. 11: the share of the frames given to the system whose pose it found.
/// @throws std::invalid_argument when `frames` is 0 or below `tracked`.
double trackingRate(std::size_t tracked, std::size_t frames);

/// Improvement (%), eq. 12: by how much `error` lies below `baseline`. 100 = no error is left,
/// 0 = no change, negative = worse.
/// @throws std::invalid_argument unless `baseline` is finite and positive.
double improvement(double baseline, double error);

}  // namespace hmcdyn::evaluate

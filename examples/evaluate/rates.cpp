// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/rates.hpp"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

namespace hmcdyn::evaluate {

double trackingRate(std::size_t tracked, std::size_t frames) {
  if (frames == 0 || tracked > frames) {
    throw std::invalid_argument(fmt::format(
        "trackingRate: {} of {} frames tracked; expected at least one frame, and no more tracked "
        "than there are",
        tracked, frames));
  }
  return 100.0 * static_cast<double>(tracked) / static_cast<double>(frames);
}

double improvement(double baseline, double error) {
  if (!(baseline > 0.0) || !std::isfinite(baseline)) {
    throw std::invalid_argument(
        fmt::format("improvement: baseline is {}; expected a finite value above 0", baseline));
  }
  return 100.0 * (baseline - error) / baseline;
}

}  // namespace hmcdyn::evaluate

// SPDX-License-Identifier: BSD-3-Clause
#include "calibrate/pixel_accuracy.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

#include "evaluate/statistics.hpp"

namespace hmcdyn::calibrate {
namespace {

constexpr std::size_t kParts = 8;
constexpr double kRayleighMedian = 1.1774;  // of a distance whose coordinates have deviation 1

}  // namespace

std::vector<double> pixelDeviations(const std::vector<PixelResidual>& residuals, double redundancy,
                                    double least) {
  std::vector<std::size_t> by_size(residuals.size());
  std::iota(by_size.begin(), by_size.end(), std::size_t{0});
  std::stable_sort(by_size.begin(), by_size.end(), [&residuals](std::size_t a, std::size_t b) {
    return residuals[a].size < residuals[b].size;
  });
  std::vector<double> deviations(residuals.size(), least);
  for (std::size_t part = 0; part < kParts; ++part) {
    const std::size_t first = part * residuals.size() / kParts;
    const std::size_t end = (part + 1) * residuals.size() / kParts;
    std::vector<double> distances;
    for (std::size_t i = first; i < end; ++i) {
      distances.push_back(residuals[by_size[i]].distance);
    }
    if (distances.empty()) {
      continue;
    }
    const double deviation =
        evaluate::median(distances) / (kRayleighMedian * std::sqrt(redundancy));
    for (std::size_t i = first; i < end; ++i) {
      deviations[by_size[i]] = std::max(least, deviation);
    }
  }
  return deviations;
}

}  // namespace hmcdyn::calibrate

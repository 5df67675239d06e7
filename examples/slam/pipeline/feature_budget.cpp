// SPDX-License-Identifier: BSD-3-Clause
#include "slam/pipeline/feature_budget.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace hmcdyn::slam {

double coveredShare(Span<const DetectionBox> boxes, const cv::Size& image) {
  // On a raster of 8 px: exact enough, and boxes may overlap in any way.
  constexpr int kRaster = 8;
  const int columns = (image.width + kRaster - 1) / kRaster;
  const int rows = (image.height + kRaster - 1) / kRaster;
  int covered = 0;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const int u = column * kRaster + kRaster / 2;
      const int v = row * kRaster + kRaster / 2;
      covered += std::any_of(boxes.begin(), boxes.end(),
                             [&](const DetectionBox& box) {
                               return box.contains(static_cast<float>(u), static_cast<float>(v));
                             })
                     ? 1
                     : 0;
    }
  }
  return columns * rows == 0 ? 0.0
                             : static_cast<double>(covered) / static_cast<double>(columns * rows);
}

int featureBudget(int base, double covered_share, double max_factor) {
  if (base <= 0 || !(max_factor >= 1.0)) {
    throw std::invalid_argument("featureBudget: base is " + std::to_string(base) + ", max_factor " +
                                std::to_string(max_factor) +
                                "; expected a count > 0 and a factor >= 1");
  }
  const double outside = std::clamp(1.0 - covered_share, 1.0 / max_factor, 1.0);
  return static_cast<int>(std::lround(base / outside));
}

}  // namespace hmcdyn::slam

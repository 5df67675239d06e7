// SPDX-License-Identifier: BSD-3-Clause
#include "slam/input/camera/depth_correction.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>

#include <fmt/format.h>

namespace hmcdyn::slam {
namespace {

/// A place between two of `nodes` nodes, of a pixel among `pixels`.
struct Interval {
  int node = 0;           ///< The one before.
  double fraction = 0.0;  ///< Of the way to the next, 0..1.
};

Interval intervalOf(double pixel, int pixels, int nodes) {
  const double place = std::clamp(pixel / static_cast<double>(pixels - 1), 0.0, 1.0) * (nodes - 1);
  const int node = std::min(static_cast<int>(place), nodes - 2);
  return {node, place - node};
}

}  // namespace

bool isIdentity(const DepthCorrection& correction) {
  return correction.scale == 1.0 && std::all_of(correction.growth.begin(), correction.growth.end(),
                                                [](double node) { return node == 0.0; });
}

void checkCorrection(const DepthCorrection& correction) {
  if (!std::isfinite(correction.scale) || !(correction.scale > 0.0)) {
    throw std::invalid_argument(
        fmt::format("DepthCorrection: scale is {}; expected a number above 0", correction.scale));
  }
  const bool none = correction.rows == 0 && correction.columns == 0;
  if (!none && (correction.rows < 2 || correction.columns < 2)) {
    throw std::invalid_argument(
        fmt::format("DepthCorrection: grid is {} x {} nodes; expected at least 2 x 2, or none",
                    correction.rows, correction.columns));
  }
  const std::size_t nodes =
      static_cast<std::size_t>(correction.rows) * static_cast<std::size_t>(correction.columns);
  if (correction.growth.size() != nodes) {
    throw std::invalid_argument(
        fmt::format("DepthCorrection: growth has {} nodes; expected rows x columns = {}",
                    correction.growth.size(), nodes));
  }
  for (const double node : correction.growth) {
    if (!std::isfinite(node)) {
      throw std::invalid_argument(
          fmt::format("DepthCorrection: growth has a node of {}; expected finite numbers", node));
    }
  }
}

GridWeights gridWeights(int rows, int columns, double u, double v, cv::Size image) {
  const Interval x = intervalOf(u, image.width, columns);
  const Interval y = intervalOf(v, image.height, rows);
  const int first = y.node * columns + x.node;
  return {{first, first + 1, first + columns, first + columns + 1},
          {(1.0 - x.fraction) * (1.0 - y.fraction), x.fraction * (1.0 - y.fraction),
           (1.0 - x.fraction) * y.fraction, x.fraction * y.fraction}};
}

double growthAt(const DepthCorrection& correction, double u, double v, cv::Size image) {
  if (correction.growth.empty()) {
    return 0.0;
  }
  const GridWeights weights = gridWeights(correction.rows, correction.columns, u, v, image);
  double growth = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    growth += weights.weight[i] * correction.growth[static_cast<std::size_t>(weights.node[i])];
  }
  return growth;
}

cv::Mat correctDepth(const cv::Mat& depth, const DepthCorrection& correction) {
  if (depth.type() != CV_32FC1 || depth.rows < 2 || depth.cols < 2) {
    throw std::invalid_argument(fmt::format(
        "correctDepth: depth is {} x {} pixels of type {}; expected at least 2 x 2 of CV_32FC1",
        depth.cols, depth.rows, depth.type()));
  }
  checkCorrection(correction);
  if (isIdentity(correction)) {
    return depth;
  }
  cv::Mat corrected(depth.size(), CV_32FC1);
  // Along a row growth is linear between the nodes' columns: one interpolation a pixel.
  std::vector<double> of_row(static_cast<std::size_t>(std::max(correction.columns, 2)), 0.0);
  for (int v = 0; v < depth.rows; ++v) {
    if (correction.rows > 0) {
      const Interval y = intervalOf(v, depth.rows, correction.rows);
      const double* upper =
          &correction.growth[static_cast<std::size_t>(y.node * correction.columns)];
      for (std::size_t i = 0; i < of_row.size(); ++i) {
        of_row[i] = upper[i] + y.fraction * (upper[i + of_row.size()] - upper[i]);
      }
    }
    const auto* from = depth.ptr<float>(v);
    auto* to = corrected.ptr<float>(v);
    for (int u = 0; u < depth.cols; ++u) {
      const Interval x = intervalOf(u, depth.cols, static_cast<int>(of_row.size()));
      const auto left = static_cast<std::size_t>(x.node);
      const double growth = of_row[left] + x.fraction * (of_row[left + 1] - of_row[left]);
      const auto z = static_cast<double>(from[u]);
      to[u] = static_cast<float>(std::max(0.0, z * (correction.scale + growth * z)));
    }
  }
  return corrected;
}

}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#include "slam/loop/coverage.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "slam/features/hamming_distance.hpp"
#include "slam/map/optimization_input.hpp"

namespace hmcdyn::slam {

Cell cellOf(double u, double v, double side) {
  // Far outside any image is one place, too.
  const auto place = [side](double pixel) {
    return static_cast<int>(std::floor(std::clamp(pixel, -1e6, 1e6) / side));
  };
  return {place(u), place(v)};
}

double Coverage::share() const {
  std::size_t asked = 0;
  std::size_t answered = 0;
  for (const auto& [cell, square] : squares_) {
    if (square.expected >= cell_points_) {
      ++asked;
      answered += static_cast<double>(square.found) >=
                          std::max(1.0, min_square_support_ * static_cast<double>(square.expected))
                      ? 1
                      : 0;
    }
  }
  return asked == 0 ? 0.0 : static_cast<double>(answered) / static_cast<double>(asked);
}

std::optional<std::pair<std::size_t, int>> alikeAround(const LoopKeyFrame& from, std::size_t i,
                                                       const LoopKeyFrame& to,
                                                       const PixelGrid& grid,
                                                       const Eigen::Vector2d& pixel, float radius,
                                                       int max_distance) {
  std::optional<std::pair<std::size_t, int>> best;
  const auto* descriptor = from.descriptors.ptr<std::uint8_t>(static_cast<int>(i));
  grid.around(pixel.x(), pixel.y(), radius, [&](std::size_t j) {
    const int distance =
        hammingDistance(descriptor, to.descriptors.ptr<std::uint8_t>(static_cast<int>(j)));
    if (distance <= max_distance && (!best || distance < best->second)) {
      best = std::make_pair(j, distance);
    }
  });
  return best;
}

double coverageIn(const LoopKeyFrame& frame, const LoopKeyFrame& key_frame,
                  const Eigen::Isometry3d& frame_from_key_frame, const PinholeCamera& camera,
                  const CoverageOptions& options) {
  requirePositive("options.radius", options.radius);
  requirePositive("options.cell", options.cell);
  std::map<Cell, std::size_t> seen;
  for (std::size_t j = 0; j < frame.points.size(); ++j) {
    if (std::isfinite(frame.points.u[j]) && std::isfinite(frame.points.v[j])) {
      ++seen[cellOf(frame.points.u[j], frame.points.v[j], options.cell)];
    }
  }
  const PixelGrid grid(frame.points, options.radius);
  Coverage coverage(options.cell_points, options.min_square_support);
  for (std::size_t i = 0; i < key_frame.points.size(); ++i) {
    if (!std::isfinite(key_frame.points.u[i]) || !std::isfinite(key_frame.points.v[i]) ||
        !hasDepth(key_frame.points.depth[i])) {
      continue;
    }
    const Eigen::Vector3d p =
        frame_from_key_frame *
        camera.unproject(key_frame.points.u[i], key_frame.points.v[i], key_frame.points.depth[i]);
    const Eigen::Vector2d pixel = camera.project(p);
    if (!(p.z() > 0.0) || !grid.covers(pixel.x(), pixel.y())) {
      continue;
    }
    const Cell cell = cellOf(pixel.x(), pixel.y(), options.cell);
    const auto here = seen.find(cell);
    if (here == seen.end() || here->second < options.cell_points) {
      continue;
    }
    coverage.expect(cell);
    if (alikeAround(key_frame, i, frame, grid, pixel, options.radius, options.max_distance)) {
      coverage.find(cell);
    }
  }
  return coverage.share();
}

}  // namespace hmcdyn::slam

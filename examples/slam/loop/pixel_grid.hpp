// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <hmcdyn/types.hpp>

namespace hmcdyn::slam {

/// Key points by place, for searches around a pixel. Points that are not finite are not in it.
class PixelGrid {
 public:
  /// @param cell side of a cell (px, > 0), best about the radius of the searches.
  PixelGrid(const KeyPoints& points, double cell) : points_(&points), cell_(cell) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (std::isfinite(points.u[i]) && std::isfinite(points.v[i])) {
        min_u_ = any_ ? std::min(min_u_, points.u[i]) : points.u[i];
        max_u_ = any_ ? std::max(max_u_, points.u[i]) : points.u[i];
        min_v_ = any_ ? std::min(min_v_, points.v[i]) : points.v[i];
        max_v_ = any_ ? std::max(max_v_, points.v[i]) : points.v[i];
        any_ = true;
      }
    }
    // A pixel far off, as bad data may have it, must not make for millions of cells.
    const double extent =
        std::max(static_cast<double>(max_u_) - min_u_, static_cast<double>(max_v_) - min_v_);
    cell_ = std::max(cell_, extent / kMostCells);
    columns_ = any_ ? column(max_u_) + 1 : 0;
    rows_ = any_ ? row(max_v_) + 1 : 0;
    cells_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (std::isfinite(points.u[i]) && std::isfinite(points.v[i])) {
        at(column(points.u[i]), row(points.v[i])).push_back(i);
      }
    }
  }

  /// Whether a pixel lies among the points: in their bounding box.
  bool covers(double u, double v) const noexcept {
    return any_ && u >= min_u_ && u <= max_u_ && v >= min_v_ && v <= max_v_;
  }

  /// Calls visit(i) for each point within a radius (px) of a pixel that the grid covers.
  template <class Visit>
  void around(double u, double v, double radius, const Visit& visit) const {
    const int left = std::max(0, column(u - radius));
    const int right = std::min(columns_ - 1, column(u + radius));
    const int top = std::max(0, row(v - radius));
    const int bottom = std::min(rows_ - 1, row(v + radius));
    for (int y = top; y <= bottom; ++y) {
      for (int x = left; x <= right; ++x) {
        for (const std::size_t i : cells_[index(x, y)]) {
          if (std::hypot(points_->u[i] - u, points_->v[i] - v) <= radius) {
            visit(i);
          }
        }
      }
    }
  }

 private:
  int column(double u) const { return static_cast<int>(std::floor((u - min_u_) / cell_)); }
  int row(double v) const { return static_cast<int>(std::floor((v - min_v_) / cell_)); }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(x);
  }
  std::vector<std::size_t>& at(int x, int y) { return cells_[index(x, y)]; }

  static constexpr double kMostCells = 256.0;  // a side

  const KeyPoints* points_;
  double cell_;
  bool any_ = false;
  float min_u_ = 0.0f;
  float max_u_ = 0.0f;
  float min_v_ = 0.0f;
  float max_v_ = 0.0f;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<std::vector<std::size_t>> cells_;
};

}  // namespace hmcdyn::slam

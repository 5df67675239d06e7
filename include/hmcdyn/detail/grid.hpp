// SPDX-License-Identifier: BSD-3-Clause
// Points in the plane sorted into square cells in which all are neighbours of each other.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <hmcdyn/detail/bits.hpp>
#include <hmcdyn/detail/planar_points.hpp>

namespace hmcdyn::detail {

/// Where the cells lie. Cell numbers grow row by row, and rows with x; empty rows and columns
/// around keep windows of 5 x 5 cells inside the numbers and within their rows.
struct GridLayout {
  double x = 0.0;  ///< Smallest coordinates.
  double y = 0.0;
  double cells_per_unit = 0.0;
  std::uint32_t rows = 0;
  std::uint32_t columns = 0;

  static constexpr std::uint32_t kMargin = 2;

  std::uint32_t stride() const noexcept { return columns + kMargin; }
  /// Number of the first cell; smaller numbers are the margin's.
  std::uint32_t origin() const noexcept { return kMargin * stride() + kMargin; }
  /// Cell of the points that are not finite: beyond every window.
  std::uint32_t trash() const noexcept { return origin() + (rows + kMargin) * stride() + columns; }
  std::size_t words() const noexcept { return trash() / 64 + 2; }
};

/// Smallest and largest coordinate.
struct Range {
  float low;
  float high;
};

/// Over the coordinates that are there; low > high without any.
inline Range rangeOf(const std::vector<float>& values) {
  std::array<float, kLanes> low{};
  std::array<float, kLanes> high{};
  low.fill(std::numeric_limits<float>::infinity());
  high.fill(-std::numeric_limits<float>::infinity());
  for (std::size_t block = 0; block < values.size(); block += kLanes) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const float value = values[block + lane];
      low[lane] = value < low[lane] ? value : low[lane];
      high[lane] = value > high[lane] ? value : high[lane];
    }
  }
  return {*std::min_element(low.begin(), low.end()), *std::max_element(high.begin(), high.end())};
}

/// Whether the points fit a grid of that radius, of a size that their number warrants; rows = 0
/// where they do not.
inline GridLayout layOutGrid(const PlanarPoints& points, float radius) {
  const Range x = rangeOf(points.x);
  const Range y = rangeOf(points.y);
  GridLayout layout;
  if (x.low > x.high) {
    return layout;
  }
  layout.x = static_cast<double>(x.low);
  layout.y = static_cast<double>(y.low);
  // The side is a little below radius / sqrt 2, so that rounding neither here nor in the cells'
  // numbers parts a cell's points.
  layout.cells_per_unit = std::sqrt(2.0) * (1.0 + 0x1p-16) / static_cast<double>(radius);
  const double rows =
      std::floor((static_cast<double>(x.high) - layout.x) * layout.cells_per_unit) + 1.0;
  const double columns =
      std::floor((static_cast<double>(y.high) - layout.y) * layout.cells_per_unit) + 1.0;
  const double most_cells =
      std::min(512.0 * static_cast<double>(std::max<std::size_t>(points.size, 4096)), 0x1p31);
  if ((rows + 6.0) * (columns + 4.0) <= most_cells) {
    layout.rows = static_cast<std::uint32_t>(rows);
    layout.columns = static_cast<std::uint32_t>(columns);
  }
  return layout;
}

/// A half-open interval of indices.
struct Interval {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;

  std::uint32_t size() const noexcept { return end - begin; }
};

/// Points sorted by cell. Only cells that hold points are kept, in the order of their numbers.
class Grid {
 public:
  std::vector<float> x;              ///< In the order of the cells; room for kLanes more.
  std::vector<float> y;              ///< The same.
  std::vector<std::uint32_t> point;  ///< What the caller calls it.
  std::vector<std::uint32_t> key;    ///< Of each cell: its number.
  std::vector<std::uint32_t> begin;  ///< Of each cell: its first point; with an end.

  std::size_t cells() const noexcept { return key.size(); }

  void fill(const PlanarPoints& points, const GridLayout& layout) {
    cell_of_point_.resize(points.padded());
    numberCells(points, layout);
    listOccupiedCells(layout);
    countPoints(points.size);
    x.resize(points.size + kLanes);
    y.resize(points.size + kLanes);
    point.resize(points.size);
    for (std::size_t i = 0; i < points.size; ++i) {
      const std::uint32_t to = next_[cell_of_point_[i]]++;
      x[to] = points.x[i];
      y[to] = points.y[i];
      point[to] = static_cast<std::uint32_t>(i);
    }
  }

  /// The cells (by position) whose numbers lie in [first, first + count).
  Interval cellsIn(std::uint32_t first, std::uint32_t count) const noexcept {
    return {rankOf(first), rankOf(first + count)};
  }

 private:
  std::uint32_t rankOf(std::uint32_t number) const noexcept {
    const std::uint64_t below = (std::uint64_t{1} << (number % 64)) - 1;
    return rank_[number / 64] + countOnes(occupied_[number / 64] & below);
  }

  void numberCells(const PlanarPoints& points, const GridLayout& layout) {
    // NaN compares false: it lands in the trash.
    const double last_row = layout.rows + GridLayout::kMargin;
    const double last_column = layout.columns;
    const auto stride = static_cast<std::int32_t>(layout.stride());
    const auto origin = static_cast<std::int32_t>(layout.origin());
    for (std::size_t block = 0; block < points.padded(); block += kLanes) {
      for (std::size_t i = block; i < block + kLanes; ++i) {
        const double row = (static_cast<double>(points.x[i]) - layout.x) * layout.cells_per_unit;
        const double column = (static_cast<double>(points.y[i]) - layout.y) * layout.cells_per_unit;
        const auto r = static_cast<std::int32_t>(row < last_row ? row : last_row);
        const auto c = static_cast<std::int32_t>(column < last_column ? column : last_column);
        cell_of_point_[i] = static_cast<std::uint32_t>(r * stride + c + origin);
      }
    }
    occupied_.assign(layout.words(), 0);
    for (std::size_t i = 0; i < points.size; ++i) {
      occupied_[cell_of_point_[i] / 64] |= std::uint64_t{1} << (cell_of_point_[i] % 64);
    }
  }

  void listOccupiedCells(const GridLayout& layout) {
    key.clear();
    rank_.resize(layout.words());
    for (std::size_t w = 0; w < occupied_.size(); ++w) {
      rank_[w] = static_cast<std::uint32_t>(key.size());
      for (std::uint64_t rest = occupied_[w]; rest != 0; rest &= rest - 1) {
        key.push_back(static_cast<std::uint32_t>(64 * w) + lowestOne(rest));
      }
    }
  }

  void countPoints(std::size_t points) {
    begin.assign(key.size() + 1, 0);
    for (std::size_t i = 0; i < points; ++i) {
      cell_of_point_[i] = rankOf(cell_of_point_[i]);
      ++begin[cell_of_point_[i] + 1];
    }
    for (std::size_t c = 0; c < key.size(); ++c) {
      begin[c + 1] += begin[c];
    }
    next_.assign(begin.begin(), begin.end());
  }

  std::vector<std::uint64_t> occupied_;       ///< A bit a cell number.
  std::vector<std::uint32_t> rank_;           ///< Occupied cells before each word.
  std::vector<std::uint32_t> cell_of_point_;  ///< Number, later position, in the caller's order.
  std::vector<std::uint32_t> next_;           ///< Of each cell: where its next point goes.
};

}  // namespace hmcdyn::detail

// SPDX-License-Identifier: BSD-3-Clause
// Points in the plane sorted into square cells in which all are neighbours of each other.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
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

/// Over the coordinates that are there; low > high without any. A block at a time, not a few lanes:
/// GCC then keeps the vectors in registers.
inline Range rangeOf(const std::vector<float>& values) {
  std::array<float, kBlock> low{};
  std::array<float, kBlock> high{};
  low.fill(std::numeric_limits<float>::infinity());
  high.fill(-std::numeric_limits<float>::infinity());
  for (std::size_t block = 0; block < values.size(); block += kBlock) {
    for (std::size_t i = 0; i < kBlock; ++i) {
      const float value = values[block + i];
      low[i] = value < low[i] ? value : low[i];
      high[i] = value > high[i] ? value : high[i];
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

/// A set of cell numbers, a bit a number.
class CellSet {
 public:
  void clear(const GridLayout& layout) { words_.assign(layout.words(), 0); }
  std::size_t words() const noexcept { return words_.size(); }
  std::uint64_t word(std::size_t w) const noexcept { return words_[w]; }

  /// `present` = false leaves the set as it is, without a branch.
  void insert(std::uint32_t number, bool present = true) noexcept {
    words_[number / 64] |= std::uint64_t{present ? 1U : 0U} << (number % 64);
  }
  void erase(std::uint32_t number) noexcept {
    words_[number / 64] &= ~(std::uint64_t{1} << (number % 64));
  }
  /// Which of the numbers first .. first + 4 are there, from the lowest bit.
  std::uint64_t window(std::uint32_t first) const noexcept {
    const std::uint32_t shift = first % 64;
    const std::uint64_t low = words_[first / 64] >> shift;
    const std::uint64_t high = words_[first / 64 + 1] << 1U << (63U - shift);
    return (low | high) & 0b11111U;
  }

 private:
  std::vector<std::uint64_t> words_;
};

/// Points sorted by cell. Only cells that hold points are kept, in the order of their numbers: a
/// cell's position.
class Grid {
 public:
  std::vector<float> x;              ///< In the order of the cells; room for kBlock more.
  std::vector<float> y;              ///< The same.
  std::vector<std::uint32_t> point;  ///< What the caller calls it.
  std::vector<std::uint32_t> key;    ///< Of each cell: its number.
  std::vector<std::uint32_t> begin;  ///< Of each cell: its first point; with an end.
  std::vector<std::uint32_t> cell;   ///< Of each point, in the caller's order; padded.

  std::size_t cells() const noexcept { return key.size(); }

  void fill(const PlanarPoints& points, const GridLayout& layout) {
    numberCells(points, layout);
    listOccupiedCells(points.size, layout);
    countPoints(points.size);
    x.resize(points.size + kBlock);
    y.resize(points.size + kBlock);
    point.resize(points.size);
    for (std::size_t i = 0; i < points.size; ++i) {
      const std::uint32_t to = begin[cell[i]] + place_[i];
      x[to] = points.x[i];
      y[to] = points.y[i];
      point[to] = static_cast<std::uint32_t>(i);
    }
  }

  /// Position of the cell of that number, or of the next one that holds points.
  std::uint32_t positionOf(std::uint32_t number) const noexcept {
    const std::uint64_t below = (std::uint64_t{1} << (number % 64)) - 1;
    return rank_[number / 64] + countOnes(occupied_.word(number / 64) & below);
  }

  /// The cells with numbers first .. first + 4.
  Interval cellsFrom(std::uint32_t first) const noexcept {
    const std::uint32_t position = positionOf(first);
    return {position, position + countOnes(occupied_.window(first))};
  }

 private:
  void numberCells(const PlanarPoints& points, const GridLayout& layout) {
    cell.resize(points.padded());
    // NaN compares false: it lands in the trash.
    const double last_row = layout.rows + GridLayout::kMargin;
    const double last_column = layout.columns;
    const auto stride = static_cast<std::int32_t>(layout.stride());
    const auto origin = static_cast<std::int32_t>(layout.origin());
    for (std::size_t block = 0; block < points.padded(); block += kLanes) {
      HMCDYN_KEEP_LOOP
      for (std::size_t i = block; i < block + kLanes; ++i) {
        const double row = (static_cast<double>(points.x[i]) - layout.x) * layout.cells_per_unit;
        const double column = (static_cast<double>(points.y[i]) - layout.y) * layout.cells_per_unit;
        const auto r = static_cast<std::int32_t>(row < last_row ? row : last_row);
        const auto c = static_cast<std::int32_t>(column < last_column ? column : last_column);
        cell[i] = static_cast<std::uint32_t>(r * stride + c + origin);
      }
    }
  }

  void listOccupiedCells(std::size_t points, const GridLayout& layout) {
    occupied_.clear(layout);
    for (std::size_t i = 0; i < points; ++i) {
      occupied_.insert(cell[i]);
    }
    key.clear();
    rank_.resize(occupied_.words());
    for (std::size_t w = 0; w < occupied_.words(); ++w) {
      rank_[w] = static_cast<std::uint32_t>(key.size());
      for (std::uint64_t rest = occupied_.word(w); rest != 0; rest &= rest - 1) {
        key.push_back(static_cast<std::uint32_t>(64 * w) + lowestOne(rest));
      }
    }
  }

  /// Turns the numbers of the points' cells into positions.
  void countPoints(std::size_t points) {
    begin.assign(key.size() + 1, 0);
    place_.resize(points);
    for (std::size_t i = 0; i < points; ++i) {
      cell[i] = positionOf(cell[i]);
      place_[i] = begin[cell[i]]++;
    }
    std::uint32_t before = 0;
    for (std::uint32_t& of_cell : begin) {
      before += std::exchange(of_cell, before);
    }
  }

  CellSet occupied_;
  std::vector<std::uint32_t> rank_;   ///< Occupied cells before each word of the set.
  std::vector<std::uint32_t> place_;  ///< Of each point: how many of its cell come before.
};

}  // namespace hmcdyn::detail

// SPDX-License-Identifier: BSD-3-Clause
// Points in any number of dimensions, sorted into cells in which all are neighbours of each other.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include <hmcdyn/detail/kd_tree.hpp>
#include <hmcdyn/detail/minkowski.hpp>
#include <hmcdyn/detail/union_find.hpp>

namespace hmcdyn::detail {

/// Cells of side radius / D^(1/p), over the columns of a D-by-N matrix that outlives them. They
/// save the search for neighbours where many points share a cell; where few do, that is cheaper.
class NeighbourCells {
 public:
  /// @param points finite, D-by-N.
  NeighbourCells(const Eigen::MatrixXf& points, const MinkowskiBall& ball)
      : points_(points), ball_(ball) {
    const auto n = static_cast<std::size_t>(points.cols());
    members_.resize(n);
    std::iota(members_.begin(), members_.end(), std::uint32_t{0});
    const Eigen::MatrixXi place = placesOf();
    if (place.size() == 0) {
      is_worth_it_ = false;
      return;
    }
    const auto before = [&](std::uint32_t a, std::uint32_t b) {
      for (Eigen::Index k = 0; k < place.rows(); ++k) {
        if (place(k, a) != place(k, b)) {
          return place(k, a) < place(k, b);
        }
      }
      return a < b;
    };
    std::sort(members_.begin(), members_.end(), before);
    std::size_t pairs = 0;
    for (std::size_t i = 0; i < n; ++i) {
      if (i == 0 || place.col(members_[i]) != place.col(members_[i - 1])) {
        begin_.push_back(i);
      }
      pairs += i - begin_.back();
    }
    begin_.push_back(n);
    constexpr std::size_t kMany = 4;  // neighbours in a point's own cell, on average
    is_worth_it_ = pairs > kMany * n;
  }

  /// Whether searches would mostly find points of one cell.
  bool areWorthIt() const noexcept { return is_worth_it_; }

  /// Marks the points whose own cell holds `min_points`, each counted as often as `times` says.
  void markFull(const std::vector<int>& times, int min_points,
                std::vector<std::uint8_t>& is_core) const {
    for (std::size_t cell = 0; cell + 1 < begin_.size(); ++cell) {
      std::int64_t here = 0;
      for (std::size_t i = begin_[cell]; i < begin_[cell + 1]; ++i) {
        here += times[members_[i]];
      }
      for (std::size_t i = begin_[cell]; here >= min_points && i < begin_[cell + 1]; ++i) {
        is_core[members_[i]] = 1;
      }
    }
  }

  /// Unites all core points that are neighbours: those of a cell, and cells with a pair.
  void unite(const std::vector<std::uint8_t>& is_core, UnionFind& sets) {
    keepCores(is_core);
    const std::size_t cells = begin_.size() - 1;
    if (cells == 0) {
      return;
    }
    Eigen::MatrixXf firsts(points_.rows(), static_cast<Eigen::Index>(cells));
    for (std::size_t cell = 0; cell < cells; ++cell) {
      firsts.col(static_cast<Eigen::Index>(cell)) = points_.col(members_[begin_[cell]]);
      for (std::size_t i = begin_[cell] + 1; i < begin_[cell + 1]; ++i) {
        sets.unite(members_[begin_[cell]], members_[i]);
      }
    }
    const KdTree tree(firsts);
    // From a cell's first point to a pair, across it, and to the other cell's first: three radii.
    constexpr float kThreeRadiiSquared = 9.01f;
    const float search = std::min(kThreeRadiiSquared * ball_.enclosingSquaredRadius(points_.rows()),
                                  std::numeric_limits<float>::max());
    for (std::size_t cell = 0; cell < cells; ++cell) {
      tree.visitWithin(
          firsts.col(static_cast<Eigen::Index>(cell)).data(), search, [&](std::uint32_t other) {
            const std::uint32_t a = members_[begin_[cell]];
            const std::uint32_t b = members_[begin_[other]];
            if (other > cell && sets.find(a) != sets.find(b) && areJoined(cell, other)) {
              sets.unite(a, b);
            }
          });
    }
  }

 private:
  /// Each point's cell; empty where coordinates are too large to number cells of that side.
  Eigen::MatrixXi placesOf() const {
    // A little smaller than it might be, so that no rounding parts a cell's points.
    const double side = ball_.sideOfNeighbours(points_.rows()) * (1.0 - 1e-4);
    constexpr double kFarthest = 0x1p30;
    Eigen::MatrixXi place(points_.rows(), points_.cols());
    for (Eigen::Index i = 0; i < points_.cols(); ++i) {
      for (Eigen::Index k = 0; k < points_.rows(); ++k) {
        const double cells = std::floor(static_cast<double>(points_(k, i)) / side);
        if (!(std::abs(cells) < kFarthest)) {
          return {};
        }
        place(k, i) = static_cast<int>(cells);
      }
    }
    return place;
  }

  /// Leaves out the other points, and cells without one; finds the box around each cell's.
  void keepCores(const std::vector<std::uint8_t>& is_core) {
    std::vector<std::uint32_t> members;
    std::vector<std::size_t> begin;
    for (std::size_t cell = 0; cell + 1 < begin_.size(); ++cell) {
      const std::size_t first = members.size();
      for (std::size_t i = begin_[cell]; i < begin_[cell + 1]; ++i) {
        if (is_core[members_[i]] != 0) {
          members.push_back(members_[i]);
        }
      }
      if (members.size() > first) {
        begin.push_back(first);
      }
    }
    begin.push_back(members.size());
    members_ = std::move(members);
    begin_ = std::move(begin);
    low_.resize(points_.rows(), static_cast<Eigen::Index>(begin_.size()) - 1);
    high_.resize(low_.rows(), low_.cols());
    for (Eigen::Index cell = 0; cell < low_.cols(); ++cell) {
      const auto at = static_cast<std::size_t>(cell);
      low_.col(cell) = points_.col(members_[begin_[at]]);
      high_.col(cell) = low_.col(cell);
      for (std::size_t i = begin_[at] + 1; i < begin_[at + 1]; ++i) {
        low_.col(cell) = low_.col(cell).cwiseMin(points_.col(members_[i]));
        high_.col(cell) = high_.col(cell).cwiseMax(points_.col(members_[i]));
      }
    }
  }

  /// Whether a point may have a neighbour in a cell: by the nearest point of the box around it.
  bool isNear(const float* point, std::size_t cell, Eigen::VectorXf& nearest) const {
    const auto at = static_cast<Eigen::Index>(cell);
    for (Eigen::Index k = 0; k < points_.rows(); ++k) {
      nearest[k] = std::min(std::max(point[k], low_(k, at)), high_(k, at));
    }
    // No point of the cell is nearer in any coordinate; std::pow may round in another order.
    constexpr float kSlack = 1.0f - 1e-5f;
    return ball_.contains(kSlack * ball_.power(point, nearest.data(), points_.rows()));
  }

  bool areJoined(std::size_t a, std::size_t b) const {
    Eigen::VectorXf nearest(points_.rows());
    const auto column = [&](std::size_t i) { return points_.col(members_[i]).data(); };
    for (std::size_t i = begin_[a]; i < begin_[a + 1]; ++i) {
      if (!isNear(column(i), b, nearest)) {
        continue;
      }
      for (std::size_t j = begin_[b]; j < begin_[b + 1]; ++j) {
        if (ball_.contains(ball_.power(column(i), column(j), points_.rows()))) {
          return true;
        }
      }
    }
    return false;
  }

  const Eigen::MatrixXf& points_;
  const MinkowskiBall& ball_;
  std::vector<std::uint32_t> members_;  ///< Points in the order of their cells.
  std::vector<std::size_t> begin_;      ///< Of each cell: its first member; with an end.
  Eigen::MatrixXf low_;                 ///< Of each cell with core points: the box around these.
  Eigen::MatrixXf high_;
  bool is_worth_it_ = false;
};

}  // namespace hmcdyn::detail

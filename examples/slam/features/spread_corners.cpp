// SPDX-License-Identifier: BSD-3-Clause
#include "slam/features/spread_corners.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <numeric>
#include <utility>

namespace hmcdyn::slam {
namespace {

/// Which parts of an area are barred: a grid of small square cells.
class Coverage {
 public:
  /// @param distance from a chosen corner inside which others are barred (px, per axis).
  Coverage(cv::Size area, double distance)
      : cells_per_pixel_(kReach / distance),
        columns_(cellOf(area.width) + 1 + 2 * kReach),
        covered_(static_cast<std::size_t>(columns_) *
                 static_cast<std::size_t>(cellOf(area.height) + 1 + 2 * kReach)) {}

  bool covers(const Corner& corner) const { return covered_[index(corner)] != 0; }
  void cover(const Corner& corner) {
    const std::size_t centre = index(corner);
    for (int row = -kReach; row <= kReach; ++row) {
      const auto first = static_cast<std::ptrdiff_t>(centre) + row * columns_ - kReach;
      std::fill_n(covered_.begin() + first, 2 * kReach + 1, std::uint8_t{1});
    }
  }

 private:
  static constexpr int kReach = 2;  // cells on each side; the grid has that many more as a margin

  int cellOf(int pixel) const { return static_cast<int>(pixel * cells_per_pixel_); }
  std::size_t index(const Corner& corner) const {
    return static_cast<std::size_t>((cellOf(corner.y) + kReach) * columns_ + cellOf(corner.x) +
                                    kReach);
  }

  double cells_per_pixel_;
  int columns_;
  std::vector<std::uint8_t> covered_;
};

/// Indices of the corners, strongest first, in scan order where they are equally strong. A counting
/// sort: strengths are small integers.
std::vector<int> orderByStrength(const std::vector<Corner>& corners) {
  int strongest = 0;
  for (const Corner& corner : corners) {
    strongest = std::max(strongest, corner.strength);
  }
  std::vector<int> next(static_cast<std::size_t>(strongest) + 2, 0);
  const auto bucket = [&](const Corner& c) {
    return static_cast<std::size_t>(strongest - c.strength);
  };
  for (const Corner& corner : corners) {
    ++next[bucket(corner) + 1];
  }
  for (std::size_t i = 1; i < next.size(); ++i) {
    next[i] += next[i - 1];
  }
  std::vector<int> order(corners.size());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    order[static_cast<std::size_t>(next[bucket(corners[i])]++)] = static_cast<int>(i);
  }
  return order;
}

/// Of corners in order of strength, those that no stronger one bars within `distance`; at most
/// `limit` of them, as indices.
std::vector<int> suppress(const std::vector<Corner>& corners, cv::Size area, double distance,
                          int limit) {
  Coverage coverage(area, distance);
  std::vector<int> chosen;
  for (std::size_t i = 0; i < corners.size() && static_cast<int>(chosen.size()) < limit; ++i) {
    if (!coverage.covers(corners[i])) {
      coverage.cover(corners[i]);
      chosen.push_back(static_cast<int>(i));
    }
  }
  return chosen;
}

/// The `count` first that remain at the largest distance which leaves that many. There must be as
/// many corners as that.
std::vector<int> suppressToCount(const std::vector<Corner>& corners, cv::Size area, int count) {
  std::vector<int> best(static_cast<std::size_t>(count));
  std::iota(best.begin(), best.end(), 0);  // what no suppression leaves
  double near_enough = 2.0;
  double too_far = 2.0 + std::sqrt(static_cast<double>(area.area()) / count);  // the mean spacing
  constexpr int kBisections = 7;
  for (int i = 0; i < kBisections; ++i) {
    const double distance = 0.5 * (near_enough + too_far);
    std::vector<int> chosen = suppress(corners, area, distance, count);
    if (static_cast<int>(chosen.size()) == count) {
      best = std::move(chosen);
      near_enough = distance;
    } else {
      too_far = distance;
    }
  }
  return best;
}

}  // namespace

std::vector<Corner> keepStrongPerCell(const std::vector<Corner>& corners, int threshold, int cell,
                                      cv::Size area) {
  const int columns = area.width / cell + 1;
  std::vector<std::uint8_t> has_strong(static_cast<std::size_t>(columns) *
                                       static_cast<std::size_t>(area.height / cell + 1));
  const auto cellOf = [&](const Corner& c) {
    return static_cast<std::size_t>(c.y / cell * columns + c.x / cell);
  };
  for (const Corner& corner : corners) {
    has_strong[cellOf(corner)] |= static_cast<std::uint8_t>(corner.score > threshold);
  }
  std::vector<Corner> kept;
  kept.reserve(corners.size());
  std::copy_if(corners.begin(), corners.end(), std::back_inserter(kept), [&](const Corner& corner) {
    return corner.score > threshold || has_strong[cellOf(corner)] == 0;
  });
  return kept;
}

std::vector<int> shareOverLevels(int total, const std::vector<int>& available, float scale_factor) {
  std::vector<int> shares(available.size(), 0);
  int left = total;
  while (left > 0) {
    double weights = 0.0;
    for (std::size_t l = 0; l < shares.size(); ++l) {
      weights += shares[l] < available[l] ? std::pow(scale_factor, -static_cast<double>(l)) : 0.0;
    }
    if (weights == 0.0) {
      break;  // every corner is taken
    }
    const int round = left;
    for (std::size_t l = 0; l < shares.size(); ++l) {
      const double part = round * std::pow(scale_factor, -static_cast<double>(l)) / weights;
      // At least one, so that each round gets on.
      const int wanted = std::max(1, static_cast<int>(std::lround(part)));
      const int given = std::min({wanted, available[l] - shares[l], left});
      shares[l] += given;
      left -= given;
    }
  }
  return shares;
}

std::vector<Corner> selectSpread(const std::vector<Corner>& corners, int count, cv::Size area,
                                 float spread_share) {
  if (count <= 0 || corners.empty()) {
    return {};
  }
  std::vector<Corner> sorted;
  sorted.reserve(corners.size());
  for (const int i : orderByStrength(corners)) {
    sorted.push_back(corners[static_cast<std::size_t>(i)]);
  }
  if (static_cast<int>(sorted.size()) <= count) {
    return sorted;
  }
  const double spacing = std::sqrt(static_cast<double>(area.area()) / count);
  Coverage coverage(area, spacing / 5.0);
  std::vector<std::uint8_t> taken(sorted.size(), 0);
  std::vector<Corner> selected;
  selected.reserve(static_cast<std::size_t>(count));
  const auto take = [&](std::size_t i) {
    taken[i] = 1;
    coverage.cover(sorted[i]);
    selected.push_back(sorted[i]);
  };
  const int spread = static_cast<int>(std::lround(spread_share * static_cast<float>(count)));
  if (spread > 0) {
    for (const int i : suppressToCount(sorted, area, spread)) {
      take(static_cast<std::size_t>(i));
    }
  }
  // The strongest of the rest: at first apart from the chosen ones, then wherever they are.
  for (const bool apart : {true, false}) {
    for (std::size_t i = 0; i < sorted.size() && static_cast<int>(selected.size()) < count; ++i) {
      if (taken[i] == 0 && !(apart && coverage.covers(sorted[i]))) {
        take(i);
      }
    }
  }
  return selected;
}

}  // namespace hmcdyn::slam

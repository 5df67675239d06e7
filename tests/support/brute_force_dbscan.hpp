// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <deque>
#include <limits>
#include <vector>

#include <Eigen/Core>

namespace hmcdyn::test {

struct BruteForceClusters {
  std::vector<int> label;  ///< -1 = noise.
  std::vector<bool> is_core;
  int clusters = 0;
};

/// The textbook's DBSCAN (Ester, Kriegel, Sander, Xu 1996): every pair is compared, clusters grow
/// from seeds, in double precision. With the tie rules that hmcdyn::densityClusters documents:
/// seeds in lexicographic order, a border point to its nearest core point, at a tie to the
/// lexicographically smaller one; a column that is not finite is noise.
class BruteForceDbscan {
 public:
  BruteForceDbscan(const Eigen::MatrixXf& points, double epsilon, int min_points, double order)
      : points_(points.cast<double>()), epsilon_(epsilon), order_(order) {
    for (Eigen::Index i = 0; i < points_.cols(); ++i) {
      if (points_.col(i).allFinite()) {
        sorted_.push_back(i);
      }
    }
    std::sort(sorted_.begin(), sorted_.end(), [this](Eigen::Index a, Eigen::Index b) {
      return std::lexicographical_compare(points_.col(a).begin(), points_.col(a).end(),
                                          points_.col(b).begin(), points_.col(b).end());
    });
    const auto n = static_cast<std::size_t>(points_.cols());
    result_.label.assign(n, -1);
    result_.is_core.assign(n, false);
    neighbours_.resize(n);
    for (const Eigen::Index i : sorted_) {
      neighbours_[at(i)] = neighboursOf(i);
      result_.is_core[at(i)] = neighbours_[at(i)].size() >= static_cast<std::size_t>(min_points);
    }
    growClusters();
    attachBorders();
  }

  const BruteForceClusters& result() const { return result_; }

 private:
  static std::size_t at(Eigen::Index i) { return static_cast<std::size_t>(i); }

  /// The distance of eq. 6 as a power: the root is monotone, and leaving it out keeps ties exact.
  double power(Eigen::Index a, Eigen::Index b) const {
    double sum = 0.0;
    for (Eigen::Index k = 0; k < points_.rows(); ++k) {
      const double difference = std::abs(points_(k, a) - points_(k, b));
      sum = std::isinf(order_) ? std::max(sum, difference) : sum + std::pow(difference, order_);
    }
    return sum;
  }

  std::vector<Eigen::Index> neighboursOf(Eigen::Index i) const {
    const double limit = std::isinf(order_) ? epsilon_ : std::pow(epsilon_, order_);
    std::vector<Eigen::Index> neighbours;
    for (const Eigen::Index j : sorted_) {
      if (power(i, j) <= limit) {
        neighbours.push_back(j);
      }
    }
    return neighbours;
  }

  void growClusters() {
    for (const Eigen::Index seed : sorted_) {
      if (!result_.is_core[at(seed)] || result_.label[at(seed)] >= 0) {
        continue;
      }
      std::deque<Eigen::Index> queue{seed};
      result_.label[at(seed)] = result_.clusters;
      while (!queue.empty()) {
        const Eigen::Index i = queue.front();
        queue.pop_front();
        for (const Eigen::Index j : neighbours_[at(i)]) {
          if (result_.is_core[at(j)] && result_.label[at(j)] < 0) {
            result_.label[at(j)] = result_.clusters;
            queue.push_back(j);
          }
        }
      }
      ++result_.clusters;
    }
  }

  void attachBorders() {
    for (const Eigen::Index i : sorted_) {
      if (result_.is_core[at(i)]) {
        continue;
      }
      double nearest = std::numeric_limits<double>::infinity();
      for (const Eigen::Index j : neighbours_[at(i)]) {  // in lexicographic order
        if (result_.is_core[at(j)] && power(i, j) < nearest) {
          nearest = power(i, j);
          result_.label[at(i)] = result_.label[at(j)];
        }
      }
    }
  }

  Eigen::MatrixXd points_;
  double epsilon_;
  double order_;
  std::vector<Eigen::Index> sorted_;                   ///< Finite points, lexicographic.
  std::vector<std::vector<Eigen::Index>> neighbours_;  ///< In the order of sorted_.
  BruteForceClusters result_;
};

}  // namespace hmcdyn::test

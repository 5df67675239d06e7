// SPDX-License-Identifier: BSD-3-Clause
// The textbook's DBSCAN over nanoflann, as one writes it by hand.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <nanoflann.hpp>

namespace hmcdyn::bench {

struct Point2 {
  float x = 0.0f;
  float y = 0.0f;
};

/// Keeps its memory from call to call; the tree's dimension is fixed at compile time.
class NanoflannDbscan {
 public:
  /// @param sorted whether searches sort what they find, as is nanoflann's default.
  explicit NanoflannDbscan(bool sorted = false) : sorted_(sorted) {}

  /// Labels 0 .. clusters - 1, -1 = noise; valid until the next call.
  const std::vector<int>& cluster(const std::vector<Point2>& points, float epsilon,
                                  int min_points) {
    const Cloud cloud{&points};
    const Tree tree(2, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(10));
    const float squared_radius = epsilon * epsilon;
    const nanoflann::SearchParams parameters(0, 0.0f, sorted_);
    const auto neighboursOf = [&](std::size_t i) {
      return tree.radiusSearch(&points[i].x, squared_radius, matches_, parameters);
    };
    label_.assign(points.size(), kUnseen);
    int clusters = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (label_[i] != kUnseen) {
        continue;
      }
      if (neighboursOf(i) < static_cast<std::size_t>(min_points)) {
        label_[i] = -1;
        continue;
      }
      label_[i] = clusters;
      queue_.clear();
      enqueueMatches(clusters);
      for (std::size_t k = 0; k < queue_.size(); ++k) {
        if (neighboursOf(queue_[k]) >= static_cast<std::size_t>(min_points)) {
          enqueueMatches(clusters);
        }
      }
      ++clusters;
    }
    return label_;
  }

 private:
  static constexpr int kUnseen = -2;

  // NOLINTBEGIN(readability-identifier-naming): nanoflann asks for these names
  struct Cloud {
    const std::vector<Point2>* points;
    std::size_t kdtree_get_point_count() const { return points->size(); }
    float kdtree_get_pt(std::size_t index, std::size_t dimension) const {
      return dimension == 0 ? (*points)[index].x : (*points)[index].y;
    }
    template <class Box>
    bool kdtree_get_bbox(Box& /*box*/) const {
      return false;
    }
  };
  // NOLINTEND(readability-identifier-naming)
  using Metric = nanoflann::L2_Simple_Adaptor<float, Cloud, float, std::uint32_t>;
  using Tree = nanoflann::KDTreeSingleIndexAdaptor<Metric, Cloud, 2, std::uint32_t>;

  void enqueueMatches(int cluster) {
    for (const auto& match : matches_) {
      int& label = label_[match.first];
      if (label == kUnseen) {
        queue_.push_back(match.first);
      }
      if (label < 0) {
        label = cluster;
      }
    }
  }

  bool sorted_;
  std::vector<int> label_;
  std::vector<std::uint32_t> queue_;
  std::vector<std::pair<std::uint32_t, float>> matches_;
};

}  // namespace hmcdyn::bench

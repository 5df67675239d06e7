// SPDX-License-Identifier: BSD-3-Clause
// nanoflann behind one small interface; its versions' differences live here and nowhere else.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <vector>

#include <Eigen/Core>
#include <nanoflann.hpp>

namespace hmcdyn::detail {

#if NANOFLANN_VERSION >= 0x150
using NanoflannSearchParameters = nanoflann::SearchParameters;  // renamed in 1.5
#else
using NanoflannSearchParameters = nanoflann::SearchParams;
#endif

/// Squared Euclidean distance, indices of 32 bits.
#if NANOFLANN_VERSION >= 0x140
template <class Cloud>
using NanoflannMetric = nanoflann::L2_Simple_Adaptor<float, Cloud, float, std::uint32_t>;
#else
template <class Cloud>  // until 1.4 the metric did not know the index type
using NanoflannMetric = nanoflann::L2_Simple_Adaptor<float, Cloud, float>;
#endif

/// A kd-tree over the columns of a D-by-N matrix that outlives it.
class KdTree {
 public:
  explicit KdTree(const Eigen::MatrixXf& points)
      : cloud_{&points},
        index_(static_cast<int>(points.rows()), cloud_,
               nanoflann::KDTreeSingleIndexAdaptorParams(10)) {
    index_.buildIndex();
  }

  /// Calls `visit(index)` for every column whose squared Euclidean distance from the query is below
  /// the given one, in no particular order; until it returns false, where it returns bool.
  template <class Visit>
  void visitWithin(const float* query, float squared_radius, Visit&& visit) const {
    Visitor<Visit> visitor{squared_radius, visit};
    index_.findNeighbors(visitor, query, NanoflannSearchParameters());
  }

 private:
  // NOLINTBEGIN(readability-identifier-naming): nanoflann asks for these names
  struct Cloud {
    const Eigen::MatrixXf* points;
    std::size_t kdtree_get_point_count() const { return static_cast<std::size_t>(points->cols()); }
    float kdtree_get_pt(std::size_t index, std::size_t dimension) const {
      return (*points)(static_cast<Eigen::Index>(dimension), static_cast<Eigen::Index>(index));
    }
    template <class Box>
    bool kdtree_get_bbox(Box& /*box*/) const {
      return false;
    }
  };
  // NOLINTEND(readability-identifier-naming)

  /// nanoflann's result-set concept.
  template <class Visit>
  struct Visitor {
    using DistanceType = float;
    using IndexType = std::uint32_t;

    float squared_radius = 0.0f;
    Visit& visit;
    std::size_t found = 0;

    std::size_t size() const { return found; }
    bool empty() const { return found == 0; }
    bool full() const { return true; }
    float worstDist() const { return squared_radius; }
    bool addPoint(float squared_distance, std::uint32_t index) {
      if (squared_distance < squared_radius) {
        ++found;
        if constexpr (std::is_same_v<decltype(visit(index)), bool>) {
          return visit(index);
        } else {
          visit(index);
        }
      }
      return true;
    }
    void sort() const {}
  };

  using Metric = NanoflannMetric<Cloud>;
  using Index = nanoflann::KDTreeSingleIndexAdaptor<Metric, Cloud, -1, std::uint32_t>;

  Cloud cloud_;
  Index index_;
};

}  // namespace hmcdyn::detail

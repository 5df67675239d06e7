// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <hmcdyn/steps/epipolar.hpp>
#include <hmcdyn/types.hpp>

#include "arrays.hpp"

namespace hmcdyn::python {

/// Key points in three arrays, which it holds on to.
struct KeyPointColumns {
  Column<float> u, v, depth;

  KeyPointColumns(const ArrayLike& columns, const ArrayLike& rows, const ArrayLike& depths)
      : u(column<float>(columns, "u")),
        v(column<float>(rows, "v")),
        depth(column<float>(depths, "depth")) {}
  KeyPointsView view() const { return {u.values, v.values, depth.values}; }
};

/// Pairs of pixels in four arrays, which it holds on to.
struct PairColumns {
  Column<float> earlier_u, earlier_v, current_u, current_v;

  PairColumns(const ArrayLike& u1, const ArrayLike& v1, const ArrayLike& u2, const ArrayLike& v2)
      : earlier_u(column<float>(u1, "earlier_u")),
        earlier_v(column<float>(v1, "earlier_v")),
        current_u(column<float>(u2, "current_u")),
        current_v(column<float>(v2, "current_v")) {}
  PointPairsView view() const {
    return {earlier_u.values, earlier_v.values, current_u.values, current_v.values};
  }
};

}  // namespace hmcdyn::python

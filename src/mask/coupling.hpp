// SPDX-License-Identifier: BSD-3-Clause
// How much neighbouring pixels of a frame belong to one surface of one thing.
#pragma once

#include <vector>

#include "mask/model.hpp"
#include "mask/small_frame.hpp"

namespace hmcdyn::internal {

/// Of each pixel, 0 .. 1.
struct Couplings {
  std::vector<float> left;           ///< With the one on its left.
  std::vector<float> above;          ///< With the one above.
  std::vector<float> inverse_depth;  ///< Workspace: of each pixel (1/m), 0 = none.
  std::vector<float> whole;          ///< Workspace: of a row, what creases leave of a coupling.
};

/// Neighbours part at a depth edge, and along a concave crease: things are mostly convex, and where
/// one touches what it stands on or before, surfaces meet at an inward angle (Stein, Schoeler,
/// Papon and Woergoetter, Object partitioning using local convexity, CVPR 2014).
/// @param with_creases false: at depth edges alone. @param reuse its memory is taken over.
Couplings coupleNeighbours(const SmallFrame& frame, const MaskModel& model, bool with_creases,
                           Couplings reuse);

}  // namespace hmcdyn::internal

// SPDX-License-Identifier: BSD-3-Clause
// Evidence spreads along surfaces and stops at depth edges.
#pragma once

#include <vector>

#include "mask/evidence.hpp"

namespace hmcdyn::internal {

struct SmoothingWorkspace {
  std::vector<float> left;   ///< Coupling of each pixel with the one on its left, 0..1.
  std::vector<float> above;  ///< With the one above.
  std::vector<Evidence> lines;
  std::vector<Evidence> image;
};

/// Normalised convolution by two rounds of two-sided recursive filters along rows and columns.
/// @param evidence of each pixel; afterwards the sums around it.
void spreadAlongSurfaces(const SmallFrame& frame, const SegmentModel& model,
                         std::vector<Evidence>& evidence, SmoothingWorkspace& workspace);

/// -1 .. 1 of the sums; 0 where nothing is known.
float beliefOf(const Evidence& sums);

/// True where the sums say anything.
bool isKnown(const Evidence& sums);

}  // namespace hmcdyn::internal

// SPDX-License-Identifier: BSD-3-Clause
// Evidence spreads along surfaces and stops where they part.
#pragma once

#include <vector>

#include "mask/coupling.hpp"
#include "mask/evidence.hpp"

namespace hmcdyn::internal {

struct SmoothingWorkspace {
  std::vector<Evidence> lines;
  std::vector<Evidence> image;
};

/// Normalised convolution by two rounds of two-sided recursive filters along rows and columns.
/// @param evidence of each pixel; afterwards the sums around it.
void spreadAlongSurfaces(const Couplings& couplings, int image_width,
                         std::vector<Evidence>& evidence, SmoothingWorkspace& workspace);

/// -1 .. 1 of the sums; 0 where nothing is known.
float beliefOf(const Evidence& sums);

/// True where the sums say anything.
bool isKnown(const Evidence& sums);

}  // namespace hmcdyn::internal

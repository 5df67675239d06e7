// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace hmcdyn::calibrate {

/// A key point and how far it is from where its point of the scene is projected to.
struct PixelResidual {
  float size = 0.0f;      ///< Of the key point (px).
  double distance = 0.0;  ///< (px), >= 0.
};

/// Standard deviation of a coordinate of each key point (px), as the residuals themselves tell: the
/// key points are sorted by size and cut into eight parts of as many each, and a part has that of
/// the normal distribution with its median distance. Large key points lie over several surfaces
/// and are found five to ten times worse than small ones; the median does not mind wrong matches.
/// @param redundancy 0..1, above 0: share of the equations that is left over, by which a solution's
/// residuals are smaller than the errors.
/// @param least no deviation is below it (px).
/// @return as many as residuals.
std::vector<double> pixelDeviations(const std::vector<PixelResidual>& residuals, double redundancy,
                                    double least);

}  // namespace hmcdyn::calibrate

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "slam/features/fast_corners.hpp"

namespace hmcdyn::slam {

/// Corners without the weak ones of the cells that have a strong one: a score above `threshold` is
/// strong. So weak corners count only where the image offers nothing better. Keeps the order.
/// @param cell side of the square cells (px, > 0); @param area size of the level (px).
std::vector<Corner> keepStrongPerCell(const std::vector<Corner>& corners, int threshold, int cell,
                                      cv::Size area);

/// How `total` key points are shared out over the levels: level l in proportion to
/// scale_factor^-l, and what a level cannot deliver goes to the others in the same proportion.
/// @param available corners of each level.
std::vector<int> shareOverLevels(int total, const std::vector<int>& available, float scale_factor);

/// The `count` corners (all, where there are fewer) that are strong and spread over the area.
/// A share of them by suppression via square covering (Bailo et al. 2018): strongest first, each
/// one bars its surroundings, whose size is searched so that the share is reached. Then the
/// strongest of the rest with a smaller distance to the chosen ones, sqrt(area / count) / 5: where
/// the texture is, more points find their match. Deterministic; ordered as chosen.
/// @param corners in scan order; @param area size of the level (px).
/// @param spread_share 0..1.
std::vector<Corner> selectSpread(const std::vector<Corner>& corners, int count, cv::Size area,
                                 float spread_share);

}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <opencv2/core.hpp>

namespace hmcdyn::slam {

/// A corner at the pixel (x, y) of its pyramid level.
struct Corner {
  int x = 0;
  int y = 0;
  int score = 0;     ///< FAST score (grey levels): the corner exists at every threshold below it.
  int strength = 0;  ///< Scores of the 3x3 neighbourhood, weighted 1-2-1 by 1-2-1: 0..16*255.
};

/// FAST-9 scores (Rosten and Drummond 2006) of the pixels in `region` of an 8-bit grey image: the
/// largest t for which 9 neighbours in a row on the circle of 16 all differ from the centre by t or
/// more, all brighter or all darker; 0 where that is not above the threshold.
/// @param region at least 3 px inside the image, its right end at column 19 or beyond.
/// @param buffer reused where it fits; outside the region its content is undefined.
cv::Mat fastScores(const cv::Mat& image, const cv::Rect& region, int threshold, cv::Mat buffer);

/// Corners of `region`: a score above 0 and no larger one among the 8 neighbours; of equal
/// neighbours the first in scan order counts, which is the order of the result, too. The scores
/// must cover 1 px around the region, whose right end must lie at column 17 or beyond.
std::vector<Corner> localMaxima(const cv::Mat& scores, const cv::Rect& region);

/// Where between the pixels a local maximum of the scores lies: the vertex of a parabola in each
/// direction through the scores, smoothed 1-2-1 across it. Within half a pixel of 0.
cv::Point2f subPixelOffset(const cv::Mat& scores, int x, int y);

}  // namespace hmcdyn::slam

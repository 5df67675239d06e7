// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <opencv2/core.hpp>

namespace hmcdyn::calibrate {

/// Where an image shows a point of the scene.
struct TrackPoint {
  int image = 0;      ///< Index of the image.
  cv::Point2f pixel;  ///< Pixel centres at whole numbers (px).
  float size = 0.0f;  ///< Diameter of what the key point looks at (px).
};

/// A point of the scene, in increasing order of the images; at most once in each.
using Track = std::vector<TrackPoint>;

struct TrackOptions {
  int features = 1200;  ///< SIFT key points an image, > 0.
  /// Which images are matched: so many places apart, each > 0. Near ones give the chain, far ones
  /// the parallax and what ties the ends of a path together.
  std::vector<int> gaps{1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48};
  double ratio = 0.8;  ///< Nearest to second nearest descriptor at most, 0..1 (Lowe 2004).
  double epipolar_distance = 1.5;  ///< Of a match from the pair's fundamental matrix (px), > 0.
  int least_matches = 20;          ///< Pairs with fewer tell nothing, >= 8.
};

/// Follows points through images of a scene where nothing moves: SIFT (Lowe 2004), matched both
/// ways, checked by a fundamental matrix for each pair, joined where no image would see a point
/// twice. The same images give the same tracks. Tracks have at least two points.
/// @param images CV_8UC1. @throws std::invalid_argument for options out of range.
std::vector<Track> featureTracks(const std::vector<cv::Mat>& images,
                                 const TrackOptions& options = {});

}  // namespace hmcdyn::calibrate

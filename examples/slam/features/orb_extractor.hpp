// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "slam/features/fast_corners.hpp"
#include "slam/features/orb_pattern.hpp"

namespace hmcdyn::slam {

/// Key points with their descriptors.
struct Features {
  /// pt: sub-pixel position in the image, pixel centres at whole numbers (px). octave: pyramid
  /// level. size: diameter of the described patch (px of the image). angle: of the intensity
  /// centroid, clockwise in the image (deg, [0, 360)). response: smoothed FAST score, 0..255.
  std::vector<cv::KeyPoint> key_points;
  cv::Mat descriptors;  ///< N x 32, CV_8U, row i for key point i; empty where there are none.
};

/// What to extract.
struct OrbOptions {
  int features = 1000;         ///< Key points wanted, > 0; fewer where the image lacks corners.
  float scale_factor = 1.2f;   ///< Size ratio of two pyramid levels, > 1.
  int levels = 8;              ///< Pyramid levels, 1..32; levels too small for a patch stay empty.
  int fast_threshold = 20;     ///< Corners above this are strong (grey levels, 1..254).
  int min_fast_threshold = 7;  ///< Least threshold, for cells without a strong corner (1..254).
  int cell = 40;               ///< Side of those cells (px of the level, > 0).
  float spread_share = 0.6f;   ///< Part spread as evenly as possible, 0..1; the rest goes where the
                               ///< strongest corners are.
};

/// @throws std::invalid_argument naming the field that is out of its range.
void checkOrbOptions(const OrbOptions& options);

/// Oriented FAST and rotated BRIEF (Rublee et al. 2011) on an image pyramid, spread over the image.
/// The image is smoothed lightly, and corners are located between the pixels. The same image
/// gives the same features bit for bit, whatever was extracted before and however many threads
/// OpenCV uses. Holds buffers that are reused: one extractor a thread.
class OrbExtractor {
 public:
  /// @throws std::invalid_argument on bad options.
  explicit OrbExtractor(const OrbOptions& options = {});

  /// Ordered by level, then as selected.
  /// @param gray 8-bit, one channel. @param mask of the same size and type, key points lie where it
  /// is not 0; empty = everywhere.
  /// @param wanted key points in place of OrbOptions::features; 0 = those.
  /// @throws std::invalid_argument on an empty image, another type or size, or wanted < 0.
  Features extract(const cv::Mat& gray, const cv::Mat& mask = {}, int wanted = 0);

  const OrbOptions& options() const noexcept { return options_; }

 private:
  struct Level {
    cv::Mat image;
    cv::Mat smooth;  // for the descriptors
    cv::Mat scores;
    std::vector<Corner> corners;
  };

  void makeLevel(std::size_t index, const cv::Mat& gray);
  void findCorners(Level& level, const cv::Mat& mask) const;
  void describeLevel(std::size_t index, int count, Features& features);

  OrbOptions options_;
  OrbPattern pattern_;
  std::vector<Level> levels_;
};

}  // namespace hmcdyn::slam

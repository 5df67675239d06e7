// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include <hmcdyn/regions.hpp>

namespace hmcdyn::slam {

/// Where things that may move are in a frame, to the pixel.
struct FrameMask {
  cv::Mat labels;                    ///< CV_32SC1, 0 = background; empty = there is no mask.
  std::vector<LabelRegion> regions;  ///< All labels but 0.

  bool empty() const noexcept { return labels.empty(); }
};

/// A mask from what a segmentation gives, be it a number an instance or a number a class: what
/// hangs together under one label becomes one region, so that two people of one class are two.
/// Pieces of fewer than 64 px, too small to be judged alone, belong to the largest piece of their
/// label. Regions come in the order of labels, then of their first pixel.
/// @param labels CV_8UC1 or CV_16UC1, 0 = background. @param margin by which each region is larger
/// than its mask (px), since a corner at a silhouette is made of both surfaces.
/// @throws std::invalid_argument for an empty image, one of another type, or a negative margin.
FrameMask makeFrameMask(const cv::Mat& labels, int margin = 0, int class_id = kPersonClassId);

/// The share of the pixels that lie in a region, 0..1; 0 without a mask.
double coveredShare(const FrameMask& mask);

}  // namespace hmcdyn::slam

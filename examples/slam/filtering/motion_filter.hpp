// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include <hmcdyn/dynamic_feature_filter.hpp>

#include "slam/detection/frame_mask.hpp"
#include "slam/tracking/frame.hpp"

namespace hmcdyn::slam {

struct MotionFilterOptions {
  DynamicFeatureFilterOptions filter;
  /// Ages (s) of the earlier frames to compare with; for each, the youngest frame that is at least
  /// so old. 0 = the neighbour. A slow person shows over the longer baseline only.
  std::vector<double> baselines = {0.0, 0.1};
  double soft_weight_gate = 0.6;  ///< The 0.6 rule; above this share of points, eq. 7's weights.
  bool soft_weights = true;       ///< false = weights 0 and 1 only (the paper's OPW ablation).
};

/// Feeds the library's filter from frame to frame: keeps the images of the last moments, picks the
/// earlier frames to compare with, and writes labels and weights into the frame.
class MotionFilter {
 public:
  explicit MotionFilter(MotionFilterOptions options);

  /// Filters the frame's key points and remembers its image.
  /// @param gray CV_8UC1, undistorted. @param depth CV_32FC1 (m), of the same size.
  /// @param mask takes the place of the boxes where it is not empty.
  DynamicFeatureFilterResult filter(const cv::Mat& gray, const cv::Mat& depth,
                                    Span<const DetectionBox> boxes, Frame& frame,
                                    const FrameMask& mask = {});

 private:
  struct Remembered {
    double timestamp;
    FlowPyramid pyramid;
  };

  std::vector<EarlierFrame> selectEarlier(double timestamp) const;
  void forgetBefore(double timestamp);

  MotionFilterOptions options_;
  DynamicFeatureFilterWorkspace workspace_;
  std::deque<Remembered> history_;
  MotionBelief memory_;  ///< What the last frame believed.
};

}  // namespace hmcdyn::slam

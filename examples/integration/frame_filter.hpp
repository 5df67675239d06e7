// SPDX-License-Identifier: BSD-3-Clause
// The library as a SLAM front end calls it: one object, one call a frame, OpenCV's types.
#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include <opencv2/core.hpp>

#include <hmcdyn/dynamic_feature_filter.hpp>
#include <hmcdyn/label_image.hpp>

namespace hmcdyn::integration {

struct FrameFilterOptions {
  DynamicFeatureFilterOptions filter;
  /// Ages (s) of the earlier frames to compare with; for each, the youngest frame that is at least
  /// so old. 0 = the neighbour. A slow person shows over the longer baseline only.
  std::vector<double> baselines = {0.0, 0.1};
  double soft_weight_gate = 0.6;  ///< Above this share of points in dynamic boxes eq. 7's weights.
  bool soft_weights = true;       ///< false = weights 0 and 1 only.
};

/// What a front end holds once its key points have depths. Image, depth and key points are of one
/// undistorted (rectified) camera.
struct FrameInput {
  double timestamp = 0.0;  ///< (s), above the last frame's.
  cv::Mat gray;            ///< CV_8UC1; what is needed of it is copied.
  /// CV_32FC1 (m), of the image's size; 0 or NaN = none. Empty = no depth camera: no beliefs.
  cv::Mat depth;
  Span<const cv::KeyPoint> key_points;  ///< N.
  /// N depths (m), as your system reads them (ORB-SLAM's mvDepth); 0, negative or NaN = none.
  /// Empty = the depth image's nearest pixels.
  Span<const float> point_depth = {};
};

/// Masks in place of boxes: a label per pixel, and which labels may move.
struct RegionMask {
  cv::Mat labels;  ///< CV_8UC1, CV_16UC1 or CV_32SC1, of the image's size.
  std::vector<LabelRegion> regions;
};

struct FrameFilterResult {
  std::vector<std::uint8_t> keep;      ///< N flags: 0 = on a moving thing, drop it.
  std::vector<float> weight;           ///< N weights, 0..1, for the pose refinement; 0 = dropped.
  bool soft_weights = false;           ///< `weight` is eq. 7's, not 0 and 1 only.
  DynamicFeatureFilterResult details;  ///< Labels, distances, and why (docs/integration.md).
};

/// Filters frame after frame. Owns what the filter needs of earlier frames (images, beliefs), since
/// a tracker overwrites its own. One object a camera, one thread at a time.
class FrameFilter {
 public:
  /// @throws std::invalid_argument for a baseline that is negative or not finite.
  explicit FrameFilter(FrameFilterOptions options = {});

  /// Filters the frame's key points by a detector's boxes, and remembers the frame. The first frame
  /// has nothing to be compared with: all is kept.
  /// @throws std::invalid_argument for a time stamp that is not above the last one, an image of the
  /// wrong type or size, arrays of unequal sizes, a bad option; the frame is then not remembered.
  FrameFilterResult filter(const FrameInput& frame, Span<const DetectionBox> boxes);

  /// The same by a mask. A point belongs to the region at its pixel; the background in a person's
  /// box is none of it.
  /// @throws std::invalid_argument as above.
  FrameFilterResult filter(const FrameInput& frame, const RegionMask& mask);

  /// Forgets all frames: call it when your tracker resets, starts a new map, or jumps in time.
  void reset() noexcept;

 private:
  struct Remembered {
    double timestamp = 0.0;
    FlowPyramid pyramid;
    MotionBelief belief;  ///< What was believed of that frame's points.
  };
  /// A frame made ready for the library.
  struct Prepared {
    Remembered current;
    KeyPoints points;
    std::vector<EarlierFrame> earlier;
    const MotionBelief* memory = nullptr;  ///< Of earlier[0].
  };

  void checkFrame(const FrameInput& frame) const;
  Prepared prepare(const FrameInput& frame) const;
  static DynamicFeatureFilterInput inputOf(const Prepared& prepared, const cv::Mat& depth);
  FrameFilterResult finish(DynamicFeatureFilterResult details, Remembered current);

  FrameFilterOptions options_;  ///< Baselines in rising order.
  DynamicFeatureFilterWorkspace workspace_;
  std::deque<Remembered> history_;  ///< Oldest first.
};

}  // namespace hmcdyn::integration

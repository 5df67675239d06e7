// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include <opencv2/core.hpp>

#include <hmcdyn/optical_flow.hpp>
#include <hmcdyn/types.hpp>

#include "slam/dataset/frame.hpp"

namespace hmcdyn::slam {

/// Class of a thing that nobody named; COCO's are 0..79.
inline constexpr int kUnknownClassId = 1000;

struct MotionRegionOptions {
  int reduction = 4;         ///< Depth is segmented at 1 / reduction of the size; at least 1.
  float depth_step = 0.03f;  ///< Reduced neighbours farther apart (share of their depth) part.
  /// Reduced pixels whose depth changes more than this from row to row (share of it) belong to no
  /// segment: the floor would join all that stands on it.
  float max_slope = 0.01f;
  float min_area = 0.015f;      ///< Smaller segments, as a share of the image, are left out.
  float max_area = 0.5f;        ///< Larger ones are the room.
  double baseline = 0.12;       ///< Age of the frame that motion is compared with (s), at least.
  double history = 0.3;         ///< An older frame is not compared with (s).
  int grid_step = 24;           ///< Between the points whose flow is followed (px); at least 4.
  float min_distance = 2.0f;    ///< Of a moving point from where a static one could be (px).
  float min_moving = 0.4f;      ///< Share of a segment's points that move, for a region. 0..1.
  std::size_t min_points = 4;   ///< Segments with fewer followed points say nothing.
  double max_pause = 0.7;       ///< A region that moved stays while it pauses, for so long (s).
  float remembered_iou = 0.3f;  ///< Least overlap with a region of the frame before.
  float margin = 4.0f;          ///< Regions are widened by this (px): depth borders are ragged.
  int max_iterations = 200;     ///< Of the robust estimator of the camera's motion.
  std::uint32_t seed = 1;       ///< Of the model's draws.
  OpticalFlowOptions flow;
};

/// A connected part of the depth image without a jump in it.
struct DepthSegments {
  cv::Mat label;               ///< CV_32SC1, reduced size; -1 = no depth or too small or large.
  std::vector<cv::Rect> rect;  ///< Of each label, in the reduced image.
};

/// Connected components (4 neighbours) over depth discontinuities, without the floor.
/// @param depth CV_32FC1 (m), 0 = none; a reduced pixel has the depth of its square's middle.
DepthSegments segmentDepth(const cv::Mat& depth, const MotionRegionOptions& options);

/// Candidate regions without any detector: depth segments whose points do not move as the camera's
/// motion says. Used by one thread; the same frames give the same regions.
class MotionRegions {
 public:
  /// @throws std::invalid_argument for an option out of its range.
  explicit MotionRegions(const MotionRegionOptions& options = {});

  /// The regions of a frame: kUnknownClassId, score = share of moving points; a region that pauses
  /// keeps its last score.
  /// @param frame gray and depth of one size. A frame whose stamp does not grow, or of another
  /// size, forgets all before it.
  std::vector<DetectionBox> update(const RgbdFrame& frame);

 private:
  struct Moment {
    double timestamp = 0.0;
    FlowPyramid pyramid;
  };
  struct Region {
    DetectionBox box;
    double moved_at = 0.0;  ///< Time stamp (s) of the last frame in which it moved.
  };

  const Moment* comparable(double timestamp) const;
  void remember(double timestamp, const std::vector<DetectionBox>& moving,
                std::vector<DetectionBox> still);

  MotionRegionOptions options_;
  std::deque<Moment> history_;  ///< Oldest first, without the present.
  std::vector<Region> regions_;
};

}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <hmcdyn/frame_filter.hpp>

#include "slam/detect/frame_mask.hpp"
#include "slam/features/orb_extractor.hpp"
#include "slam/input/camera/calibration.hpp"
#include "slam/input/camera/rectifier.hpp"
#include "slam/input/dataset/frame.hpp"
#include "slam/loop/loop_closing.hpp"
#include "slam/map/local_mapper.hpp"
#include "slam/run/options.hpp"
#include "slam/run/part_errors.hpp"
#include "slam/run/trajectory_log.hpp"
#include "slam/track/tracker.hpp"
#include "support/stage_times.hpp"

namespace hmcdyn::slam {

/// Everything that one frame gave.
struct FrameOutcome {
  RgbdFrame image;                      ///< As processed: undistorted.
  std::vector<DetectionBox> boxes;      ///< In the undistorted image.
  FrameMask mask;                       ///< What the boxes are around, where there is a mask.
  KeyPoints points;                     ///< N key points.
  std::vector<float> size;              ///< N diameters of the described patches (px).
  std::vector<float> weight;            ///< N weights as the tracker used them.
  DynamicFeatureFilterResult filtered;  ///< What the filter decided about them.
  /// What moves, a pixel each; null = the filter made no mask. The filter's: it is another frame's
  /// once the next one is processed.
  const MotionMask* motion = nullptr;
  FrameFilterStatus filter_status = FrameFilterStatus::kFiltered;  ///< What that is worth.
  std::size_t kept_for_number = 0;  ///< Points that were kept since too few would be left.
  TrackingResult tracking;          ///< Where the camera is.
  bool map_moved = false;           ///< A correction was taken up after this frame.
  support::StageTimes times;        ///< What it took.
};

/// The tracking thread's work on a frame, in the order of its data: features, filter, tracking; and
/// its dealings with the mapping and the loop thread. What those threads throw is noted, and
/// tracking goes on without their result.
class Pipeline {
 public:
  /// @param corner_mask where corners are the world's; empty = everywhere.
  /// @param errors of the threads; must outlive the pipeline.
  Pipeline(const SlamOptions& options, const CameraCalibration& calibration, cv::Mat corner_mask,
           PartErrors& errors);

  /// @param image undistorted. @param boxes of the detector, in that image. @param mask in place of
  /// the boxes, which are those around its regions then.
  FrameOutcome process(const RgbdFrame& image, std::vector<DetectionBox> boxes,
                       FrameMask mask = {});

  /// Waits for the threads and takes up what they have.
  void finish();

  /// The poses of all tracked frames, as the map has them now.
  std::vector<StampedPose> trajectory() const { return log_.poses(tracker_.map()); }

  const Map& map() const noexcept { return tracker_.map(); }
  LoopClosing& loops() noexcept { return loops_; }
  const LoopClosing& loops() const noexcept { return loops_; }
  const LocalMapper& mapper() const noexcept { return mapper_; }

 private:
  Frame extract(const RgbdFrame& image, double covered_share);
  std::optional<Eigen::Isometry3d> relocalize(const Frame& lost);
  template <class Take>
  bool takeUp(const std::string& part, const Take& take);
  bool exchangeWithThreads(bool new_key_frame);

  PartErrors& errors_;
  cv::Mat corner_mask_;
  OrbExtractor extractor_;
  double max_feature_factor_;
  FrameFilter filter_;
  Tracker tracker_;
  LocalMapper mapper_;
  LoopClosing loops_;
  TrajectoryLog log_;
};

/// Where corners are the world's: the border of the rectified image is an edge that is none. Empty
/// where there is no distortion.
cv::Mat cornerMask(const Rectifier& rectifier);

}  // namespace hmcdyn::slam

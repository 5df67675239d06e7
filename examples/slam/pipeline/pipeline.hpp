// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include <hmcdyn/dynamic_feature_filter.hpp>

#include "slam/camera/calibration.hpp"
#include "slam/camera/rectifier.hpp"
#include "slam/dataset/frame.hpp"
#include "slam/detection/detector.hpp"
#include "slam/features/orb_extractor.hpp"
#include "slam/filtering/motion_filter.hpp"
#include "slam/mapping/local_mapper.hpp"
#include "slam/output/stage_times.hpp"
#include "slam/pipeline/options.hpp"
#include "slam/pipeline/trajectory_log.hpp"
#include "slam/tracking/tracker.hpp"

namespace hmcdyn::slam {

/// Everything that one frame gave.
struct FrameOutcome {
  RgbdFrame image;                      ///< As processed: undistorted.
  std::vector<DetectionBox> boxes;      ///< In the undistorted image.
  KeyPoints points;                     ///< N key points.
  std::vector<float> weight;            ///< N weights as the tracker used them.
  DynamicFeatureFilterResult filtered;  ///< What the filter decided about them.
  TrackingResult tracking;              ///< Where the camera is.
  StageTimes times;                     ///< What it took.
};

/// The system of the paper, front half: detection, features, filter, tracking, a frame at a time in
/// the order of its data.
class Pipeline {
 public:
  /// @throws std::invalid_argument or std::runtime_error where detector or options cannot be used.
  Pipeline(const SlamOptions& options, const CameraCalibration& calibration);

  FrameOutcome process(const RgbdFrame& raw);

  /// Waits for the threads and takes up what they have.
  void finish();

  /// The poses of all tracked frames, as the map has them now.
  std::vector<StampedPose> trajectory() const { return log_.poses(tracker_.map()); }

  const Map& map() const noexcept { return tracker_.map(); }

  std::string detectorName() const { return detector_->name(); }

 private:
  std::vector<DetectionBox> detect(const RgbdFrame& raw, const RgbdFrame& rectified);

  bool boxes_are_raw_;  ///< Boxes from a file refer to the image as the camera saw it.
  Rectifier rectifier_;
  cv::Mat valid_mask_;  ///< Empty = everywhere.
  std::unique_ptr<ObjectDetector> detector_;
  OrbExtractor extractor_;
  double max_feature_factor_;
  MotionFilter filter_;
  Tracker tracker_;
  LocalMapper mapper_;
  TrajectoryLog log_;
};

}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <hmcdyn/steps/box_carrier.hpp>

#include "slam/detect/detection_thread.hpp"
#include "slam/detect/detector.hpp"
#include "slam/detect/frame_mask.hpp"
#include "slam/detect/mask_folder.hpp"
#include "slam/input/camera/rectifier.hpp"
#include "slam/input/dataset/frame.hpp"
#include "slam/run/options.hpp"
#include "support/stage_times.hpp"

namespace hmcdyn::slam {

/// A frame as it came and as it is tracked.
struct PreparedFrame {
  RgbdFrame raw;
  RgbdFrame image;  ///< Undistorted; the same images where there is no distortion.
  support::StageTime rectify_time;
};

/// A frame's boxes, and where they come from.
struct FrameBoxes {
  std::vector<DetectionBox> boxes;  ///< In the undistorted image.
  FrameMask mask;                   ///< To the pixel what the boxes are around, where it is known.
  /// What the detector has just said, of this frame or of an earlier one, as lines of a box file.
  std::string found;
  bool detected = false;        ///< By the detector in this very frame; else carried on.
  std::size_t bridged = 0;      ///< Boxes that the newest detection missed.
  double detect_wall_ms = 0.0;  ///< Of the detector's thread; 0 without an answer.
  double detect_cpu_ms = 0.0;
  support::StageTime carry_time;  ///< What carrying boxes on, or reading a mask, took.
};

/// The boxes of each frame. Offline every frame waits for its own detection; in real time none
/// waits, and boxes of an earlier frame are carried to the present. Boxes that the detector missed
/// are bridged in both (SlamOptions::bridge). Masks are read when their frame is tracked, in both;
/// where one is missing or cannot be used, the boxes around the masks before it are carried on.
class DetectionFeed {
 public:
  /// @param own a detector in place of the one that the options name; it sees the undistorted
  /// image.
  /// @throws std::invalid_argument or std::runtime_error where detector or masks cannot be used.
  DetectionFeed(const SlamOptions& options, Rectifier rectifier, Report report,
                std::unique_ptr<ObjectDetector> own = nullptr);

  /// Offline: asks for a frame, at most one ahead of the frame whose boxes are taken.
  void ask(const PreparedFrame& frame);

  /// The boxes of a frame, asked for in this order.
  FrameBoxes boxesOf(const PreparedFrame& frame);

  const DetectionCounts& counts() const noexcept {
    return masks_ ? mask_counts_ : thread_.counts();
  }
  const std::string& detectorName() const noexcept { return thread_.detectorName(); }

 private:
  struct TypedDetector {
    std::string type;  ///< As DetectorOptions::type, or "own".
    std::unique_ptr<ObjectDetector> detector;
  };

  DetectionFeed(const SlamOptions& options, TypedDetector detector, Rectifier rectifier,
                Report report);
  static TypedDetector choose(const SlamOptions& options, std::unique_ptr<ObjectDetector> own);

  std::vector<DetectionBox> rectified(std::vector<DetectionBox> boxes) const;
  /// Boxes as readBoxFile() takes them: in the image as the camera saw it.
  std::string linesOf(double timestamp, const std::vector<DetectionBox>& boxes) const;
  FrameBoxes maskOf(const PreparedFrame& frame);

  bool realtime_;
  bool boxes_are_raw_;  ///< Boxes from a file refer to the image as the camera saw it.
  Rectifier rectifier_;
  Report report_;
  DetectionThread thread_;
  std::optional<MaskFolder> masks_;  ///< Instead of a detector.
  int mask_margin_;
  DetectionCounts mask_counts_;
  std::optional<BoxCarrier> carrier_;  ///< Nothing where no box is ever to be carried.
};

}  // namespace hmcdyn::slam

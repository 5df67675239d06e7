// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include <hmcdyn/types.hpp>

#include "slam/detect/detector.hpp"
#include "slam/input/source/frame_source.hpp"
#include "support/worker.hpp"

namespace hmcdyn::slam {

/// What the detector is asked.
struct DetectionRequest {
  std::size_t frame = 0;   ///< RgbdFrame::index.
  double timestamp = 0.0;  ///< Of the image (s).
  cv::Mat bgr;             ///< CV_8UC3; shared, not to be changed any more.
};

/// What the detector said about one frame.
struct Detection {
  std::size_t frame = 0;
  double timestamp = 0.0;           ///< Of the image (s).
  std::vector<DetectionBox> boxes;  ///< Empty where it failed.
  cv::Mat labels;                   ///< A mask where it makes one, Seen::labels.
  bool failed = false;              ///< The detector threw: nothing is known about this frame.
  double wall_ms = 0.0;             ///< Of the detector.
  double cpu_ms = 0.0;              ///< Of the detector's thread, helpers of OpenCV's not counted.
};

struct DetectionCounts {
  std::size_t requested = 0;
  std::size_t detected = 0;   ///< Frames that the detector answered.
  std::size_t replaced = 0;   ///< Requests that a newer frame took the place of.
  std::size_t failed = 0;     ///< Frames at which the detector threw.
  std::string first_failure;  ///< What it threw first, and at which frame; empty = it never did.
  std::string last_failure;   ///< Likewise the last; equal where there was one.
};

/// A detector on a thread of its own, asked by one other thread.
///
/// Offline: request() each frame, perhaps some ahead, and take() each one's detection in order;
/// boxes do not depend on how the threads run. Real time: requestNewest(), which never waits, and
/// tryTakeNewest(), which gives what is there. A detector slower than the camera then sees the
/// newest frame whenever it is free. One thread uses either pair.
///
/// A detector that throws is no end: the first time is reported, each is counted, and the frame
/// has no detection.
class DetectionThread {
 public:
  /// @param report takes a line when the detector first fails; called by the taking thread.
  /// @param lookahead most requests that wait; at least 1. Real time: 1, so that no frame is old.
  /// @throws std::invalid_argument for a null detector or a lookahead of 0.
  DetectionThread(std::unique_ptr<ObjectDetector> detector, Report report,
                  std::size_t lookahead = 1);

  /// Asks for a frame; waits where `lookahead` requests wait already.
  void request(DetectionRequest request);

  /// Asks for a frame; where the queue is full, its oldest request is given up.
  void requestNewest(DetectionRequest request);

  /// The next frame's detection; waits for it.
  /// @throws std::logic_error where none is asked for.
  Detection take();

  /// The newest detection that has come since the last call, if one has; older ones are passed
  /// over, failed ones counted and left out.
  std::optional<Detection> tryTakeNewest();

  /// Requests whose detection was not taken yet.
  std::size_t pending() const { return worker_.pending(); }

  const DetectionCounts& counts() const noexcept { return counts_; }
  const std::string& detectorName() const noexcept { return name_; }

 private:
  struct Answer {
    Detection detection;
    std::string error;  ///< Of a failed one.
  };

  static Answer detect(ObjectDetector& detector, const DetectionRequest& request);
  Detection account(Answer answer);

  std::string name_;
  Report report_;
  DetectionCounts counts_;
  support::Worker<DetectionRequest, Answer> worker_;
};

}  // namespace hmcdyn::slam

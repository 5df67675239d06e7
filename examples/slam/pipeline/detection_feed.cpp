// SPDX-License-Identifier: BSD-3-Clause
#include "slam/pipeline/detection_feed.hpp"

#include <optional>
#include <utility>

#include "slam/detection/detector_factory.hpp"

namespace hmcdyn::slam {

DetectionFeed::DetectionFeed(const SlamOptions& options, Rectifier rectifier, Report report)
    : realtime_(options.mode == RunMode::kRealtime),
      boxes_are_raw_(options.detector.type == "file"),
      rectifier_(std::move(rectifier)),
      carrier_(options.carrier),
      thread_(makeDetector(options.detector), std::move(report)) {}

std::vector<DetectionBox> DetectionFeed::rectified(std::vector<DetectionBox> boxes) const {
  if (boxes_are_raw_) {
    for (DetectionBox& box : boxes) {
      box = rectifier_.box(box);
    }
  }
  return boxes;
}

void DetectionFeed::ask(const PreparedFrame& frame) {
  DetectionRequest request{frame.raw.index, frame.raw.timestamp,
                           boxes_are_raw_ ? frame.raw.bgr : frame.image.bgr};
  if (realtime_) {
    thread_.requestNewest(std::move(request));
  } else {
    thread_.request(std::move(request));
  }
}

FrameBoxes DetectionFeed::boxesOf(const PreparedFrame& frame) {
  FrameBoxes result;
  std::optional<Detection> detection;
  if (realtime_) {
    detection = thread_.tryTakeNewest();
  } else {
    detection = thread_.take();
  }
  std::optional<TimedDetection> found;
  if (detection) {
    result.detect_wall_ms = detection->wall_ms;
    result.detect_cpu_ms = detection->cpu_ms;
    if (!detection->failed) {
      found = TimedDetection{detection->timestamp, rectified(std::move(detection->boxes))};
    }
  }
  const StageTimer timer;
  result.boxes = carrier_.update(frame.image.timestamp, frame.image.gray, frame.image.depth, found);
  result.carry_time = timer.elapsed("boxes");
  return result;
}

}  // namespace hmcdyn::slam

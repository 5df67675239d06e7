// SPDX-License-Identifier: BSD-3-Clause
#include "slam/pipeline/detection_feed.hpp"

#include <optional>
#include <utility>

#include "slam/detection/detector_factory.hpp"

namespace hmcdyn::slam {
namespace {

std::optional<BoxCarrier> makeCarrier(const SlamOptions& options, const std::string& type) {
  BoxCarrierOptions carrier;
  carrier.max_bridge = options.bridge;
  if (type == "file") {
    carrier.duplicate_overlap = 1.0f;  // boxes from a file are taken as they are
  }
  BoxCarrier checked(carrier);
  const bool carries = options.mode == RunMode::kRealtime || options.bridge > 0.0;
  const bool detects = type != "none" && type != "motion";
  return detects && carries ? std::optional(std::move(checked)) : std::nullopt;
}

std::optional<MotionRegions> makeRegions(const SlamOptions& options, const std::string& type) {
  if (type != "motion") {
    return std::nullopt;
  }
  MotionRegionOptions regions;
  regions.seed = options.seed;
  return MotionRegions(regions);
}

}  // namespace

DetectionFeed::DetectionFeed(const SlamOptions& options, Rectifier rectifier, Report report,
                             std::unique_ptr<ObjectDetector> own)
    : DetectionFeed(options, choose(options, std::move(own)), std::move(rectifier),
                    std::move(report)) {}

DetectionFeed::DetectionFeed(const SlamOptions& options, TypedDetector detector,
                             Rectifier rectifier, Report report)
    : realtime_(options.mode == RunMode::kRealtime),
      boxes_are_raw_(detector.type == "file"),
      rectifier_(std::move(rectifier)),
      thread_(std::move(detector.detector), std::move(report)),
      regions_(makeRegions(options, detector.type)),
      carrier_(makeCarrier(options, detector.type)) {}

DetectionFeed::TypedDetector DetectionFeed::choose(const SlamOptions& options,
                                                   std::unique_ptr<ObjectDetector> own) {
  if (own) {
    return {"own", std::move(own)};
  }
  return {options.detector.type, makeDetector(options.detector)};
}

std::vector<DetectionBox> DetectionFeed::rectified(std::vector<DetectionBox> boxes) const {
  if (boxes_are_raw_) {
    for (DetectionBox& box : boxes) {
      box = rectifier_.box(box);
    }
  }
  return boxes;
}

void DetectionFeed::ask(const PreparedFrame& frame) {
  if (regions_) {
    return;
  }
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
  if (regions_) {
    const StageTimer timer;
    result.boxes = regions_->update(frame.image);
    result.detected = true;
    result.carry_time = timer.elapsed("boxes");
    return result;
  }
  std::optional<Detection> detection;
  if (realtime_) {
    detection = thread_.tryTakeNewest();
  } else {
    detection = thread_.take();
  }
  std::optional<FrameDetection> said;
  if (detection) {
    result.detected = !detection->failed && detection->frame == frame.raw.index;
    result.detect_wall_ms = detection->wall_ms;
    result.detect_cpu_ms = detection->cpu_ms;
    if (!detection->failed) {
      said = FrameDetection{detection->frame, rectified(std::move(detection->boxes))};
    }
  }
  const StageTimer timer;
  if (carrier_) {
    result.boxes = carrier_->update(frame.image, said);
    result.bridged = carrier_->bridged();
  } else if (said) {
    result.boxes = std::move(said->boxes);
  }
  result.carry_time = timer.elapsed("boxes");
  return result;
}

}  // namespace hmcdyn::slam

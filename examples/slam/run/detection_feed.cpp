// SPDX-License-Identifier: BSD-3-Clause
#include "slam/run/detection_feed.hpp"

#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include <hmcdyn/label_image.hpp>

#include "slam/detect/detector_factory.hpp"

namespace hmcdyn::slam {
namespace {

std::optional<BoxCarrier> makeCarrier(const SlamOptions& options, const std::string& type) {
  BoxCarrierOptions carrier;
  carrier.max_bridge = options.bridge;
  if (type == "file" || type == "masks" || type == "command") {
    carrier.duplicate_overlap = 1.0f;  // they are taken as they are
  }
  if (type == "masks") {
    carrier.max_bridge = 0.0;  // a mask misses nothing
  }
  BoxCarrier checked(carrier);
  const bool carries =
      options.mode == RunMode::kRealtime || options.bridge > 0.0 || type == "masks";
  return type != "none" && carries ? std::optional(std::move(checked)) : std::nullopt;
}

std::optional<MaskFolder> openMasks(const DetectorOptions& options, const std::string& type,
                                    const Rectifier& rectifier) {
  return type == "masks" ? std::optional<MaskFolder>(std::in_place, options.masks, rectifier.size(),
                                                     options.time_tolerance)
                         : std::nullopt;
}

CarriedFrame asCarried(const RgbdFrame& frame) {
  return {frame.index, frame.timestamp, frame.gray, frame.depth};
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
      report_(report),
      thread_(std::move(detector.detector), std::move(report)),
      masks_(openMasks(options.detector, detector.type, rectifier_)),
      mask_margin_(options.detector.mask_margin),
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
  if (masks_) {
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

FrameBoxes DetectionFeed::maskOf(const PreparedFrame& frame) {
  FrameBoxes result;
  const support::StageTimer timer;
  std::optional<FrameDetection> seen;
  ++mask_counts_.requested;
  try {
    result.mask = makeFrameMask(rectifier_.depth(masks_->at(frame.raw.timestamp)), mask_margin_);
    result.boxes = boundingBoxes(result.mask.labels, result.mask.regions);
    result.detected = true;
    ++mask_counts_.detected;
    seen = FrameDetection{frame.raw.index, result.boxes};
    result.found = linesOf(frame.raw.timestamp, result.boxes);
  } catch (const std::runtime_error& error) {
    if (++mask_counts_.failed == 1) {
      report_(
          fmt::format("frame {} has no mask, boxes around earlier ones are carried on: {}; "
                      "further frames without a mask are only counted",
                      frame.raw.index, error.what()));
    }
  }
  std::vector<DetectionBox> carried = carrier_->update(asCarried(frame.image), seen);
  if (!seen) {
    result.boxes = std::move(carried);
  }
  result.carry_time = timer.elapsed("boxes");
  return result;
}

FrameBoxes DetectionFeed::boxesOf(const PreparedFrame& frame) {
  if (masks_) {
    return maskOf(frame);
  }
  FrameBoxes result;
  std::optional<Detection> detection;
  if (realtime_) {
    detection = thread_.tryTakeNewest();
  } else {
    detection = thread_.take();
  }
  std::optional<FrameDetection> said;
  FrameMask mask;  // of this very frame
  if (detection) {
    result.detected = !detection->failed && detection->frame == frame.raw.index;
    result.detect_wall_ms = detection->wall_ms;
    result.detect_cpu_ms = detection->cpu_ms;
    if (!detection->labels.empty()) {
      mask = makeFrameMask(detection->labels, mask_margin_);
      detection->boxes = boundingBoxes(mask.labels, mask.regions);
    }
    if (!detection->failed) {
      said = FrameDetection{detection->frame, rectified(std::move(detection->boxes))};
      result.found = linesOf(detection->timestamp, said->boxes);
    }
  }
  const support::StageTimer timer;
  if (carrier_) {
    result.boxes = carrier_->update(asCarried(frame.image), said);
    result.bridged = carrier_->bridged();
  } else if (said) {
    result.boxes = std::move(said->boxes);
  }
  if (result.detected && !mask.empty()) {  // a late one gives boxes to carry on, like a missing one
    result.boxes = boundingBoxes(mask.labels, mask.regions);
    result.mask = std::move(mask);
  }
  result.carry_time = timer.elapsed("boxes");
  return result;
}

std::string DetectionFeed::linesOf(double timestamp, const std::vector<DetectionBox>& boxes) const {
  std::string lines;
  for (const DetectionBox& seen : boxes) {
    const DetectionBox box = rectifier_.rawBox(seen);
    lines += fmt::format("{} {} {} {} {} {} {}\n", timestamp, box.class_id, box.x_min, box.y_min,
                         box.x_max, box.y_max, box.score);
  }
  return lines;
}

}  // namespace hmcdyn::slam

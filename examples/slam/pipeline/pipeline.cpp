// SPDX-License-Identifier: BSD-3-Clause
#include "slam/pipeline/pipeline.hpp"

#include <utility>

#include <opencv2/imgproc.hpp>

#include "slam/detection/detector_factory.hpp"
#include "slam/pipeline/feature_budget.hpp"

namespace hmcdyn::slam {
namespace {

/// Where corners are the world's: the border of the rectified image is an edge that is none.
cv::Mat cornerMask(const Rectifier& rectifier) {
  if (rectifier.isIdentity()) {
    return {};
  }
  cv::Mat mask;
  constexpr int kPatch = 2 * 19 + 1;  // px, the descriptor's patch
  cv::erode(rectifier.validMask(), mask,
            cv::getStructuringElement(cv::MORPH_RECT, cv::Size(kPatch, kPatch)));
  return mask;
}

}  // namespace

Pipeline::Pipeline(const SlamOptions& options, const CameraCalibration& calibration)
    : boxes_are_raw_(options.detector.type == "file"),
      rectifier_(calibration),
      valid_mask_(cornerMask(rectifier_)),
      detector_(makeDetector(options.detector)),
      extractor_(options.features),
      max_feature_factor_(options.max_feature_factor),
      filter_(options.filter),
      tracker_(calibration.pinhole, options.tracker),
      mapper_(options.mapping) {}

std::vector<DetectionBox> Pipeline::detect(const RgbdFrame& raw, const RgbdFrame& rectified) {
  if (!boxes_are_raw_) {
    return detector_->detect(rectified.bgr, rectified.timestamp);
  }
  std::vector<DetectionBox> boxes = detector_->detect(raw.bgr, raw.timestamp);
  for (DetectionBox& box : boxes) {
    box = rectifier_.box(box);
  }
  return boxes;
}

FrameOutcome Pipeline::process(const RgbdFrame& raw) {
  FrameOutcome outcome;
  StageTimes& times = outcome.times;
  outcome.image = times.measure("rectify", [&] { return rectify(raw, rectifier_); });
  const RgbdFrame& image = outcome.image;
  outcome.boxes = times.measure("detect", [&] { return detect(raw, image); });

  Frame frame = times.measure("features", [&] {
    const int wanted =
        featureBudget(extractor_.options().features,
                      coveredShare(outcome.boxes, image.gray.size()), max_feature_factor_);
    return makeFrame(image.index, image.timestamp,
                     extractor_.extract(image.gray, valid_mask_, wanted), image.depth, extractor_.options().scale_factor);
  });
  outcome.filtered = times.measure(
      "filter", [&] { return filter_.filter(image.gray, image.depth, outcome.boxes, frame); });
  outcome.points = frame.points;
  outcome.weight = frame.weight;
  outcome.tracking = times.measure("track", [&] { return tracker_.track(std::move(frame)); });
  if (outcome.tracking.failure == TrackingFailure::kNone) {
    log_.add(image.timestamp, outcome.tracking.camera_from_world, outcome.tracking.reference,
             tracker_.map());
  }
  times.measure("map", [&] {
    if (const std::optional<MapCorrection> correction = mapper_.poll()) {
      tracker_.apply(*correction);
    }
    if (outcome.tracking.new_key_frame) {
      mapper_.adjust(tracker_.map());
    }
  });
  return outcome;
}

void Pipeline::finish() {
  if (const std::optional<MapCorrection> correction = mapper_.finish()) {
    tracker_.apply(*correction);
  }
}

}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#include "slam/run/pipeline.hpp"

#include <utility>

#include <opencv2/imgproc.hpp>

#include "slam/run/feature_budget.hpp"
#include "slam/run/filter_frame.hpp"

namespace hmcdyn::slam {
namespace {

constexpr const char* kLocalMapping = "local mapping";
constexpr const char* kLoopClosing = "loop closing";
constexpr const char* kGoesOn = "the run goes on without its result";

FrameFilterOptions filterOptions(FrameFilterOptions options, const PinholeCamera& camera) {
  options.bridge = 0.0;  // DetectionFeed bridges: it knows late detections, too
  options.camera = camera;
  return options;
}

}  // namespace

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

Pipeline::Pipeline(const SlamOptions& options, const CameraCalibration& calibration,
                   cv::Mat corner_mask, PartErrors& errors)
    : errors_(errors),
      corner_mask_(std::move(corner_mask)),
      extractor_(options.features),
      max_feature_factor_(options.max_feature_factor),
      filter_(filterOptions(options.filter, calibration.pinhole)),
      tracker_(calibration.pinhole, options.tracker),
      mapper_(options.mapping),
      loops_(calibration.pinhole, options.loops) {}

Frame Pipeline::extract(const RgbdFrame& image, double covered_share) {
  const int wanted =
      featureBudget(extractor_.options().features, covered_share, max_feature_factor_);
  const MotionMask* before = filter_.mask();
  const cv::Mat corners = before == nullptr ? corner_mask_ : cornersOfRoom(corner_mask_, *before);
  return makeFrame(image.index, image.timestamp, extractor_.extract(image.gray, corners, wanted),
                   image.depth, extractor_.options().scale_factor);
}

std::optional<Eigen::Isometry3d> Pipeline::relocalize(const Frame& lost) {
  std::optional<Eigen::Isometry3d> found;
  errors_.attempt("relocalization", "the frame counts as not found",
                  [&] { found = loops_.relocalize(lost, tracker_.map()); });
  return found;
}

/// @param take gives a correction, or nothing. @return whether the map was moved.
template <class Take>
bool Pipeline::takeUp(const std::string& part, const Take& take) {
  std::optional<MapCorrection> correction;
  errors_.attempt(part, kGoesOn, [&] { correction = take(); });
  if (correction) {
    tracker_.apply(*correction);
  }
  return correction.has_value();
}

bool Pipeline::exchangeWithThreads(bool new_key_frame) {
  bool moved = takeUp(kLocalMapping, [this] { return mapper_.poll(); });
  const bool corrected = takeUp(kLoopClosing, [this] { return loops_.poll(tracker_.map()); });
  if (corrected) {  // the adjustment began in the map as it was before: void
    errors_.attempt(kLocalMapping, kGoesOn, [this] { mapper_.finish(); });
  }
  moved = moved || corrected;
  if (new_key_frame) {
    errors_.attempt(kLocalMapping, kGoesOn, [this] { mapper_.adjust(tracker_.map()); });
    errors_.attempt(kLoopClosing, kGoesOn, [this] { loops_.process(tracker_.map()); });
  }
  return moved;
}

FrameOutcome Pipeline::process(const RgbdFrame& image, std::vector<DetectionBox> boxes,
                               FrameMask mask) {
  FrameOutcome outcome;
  support::StageTimes& times = outcome.times;
  outcome.image = image;
  outcome.boxes = std::move(boxes);
  outcome.mask = std::move(mask);

  const double covered = outcome.mask.empty() ? coveredShare(outcome.boxes, image.gray.size())
                                              : coveredShare(outcome.mask);
  Frame frame = times.measure("features", [&] { return extract(image, covered); });
  FrameFilterResult filtered = times.measure("filter", [&] {
    return filterFrame(image, outcome.boxes, outcome.mask, tracker_, filter_, frame);
  });
  outcome.motion = filter_.mask();
  outcome.filter_status = filtered.status;
  outcome.kept_for_number = filtered.kept_for_number;
  outcome.filtered = std::move(filtered.details);
  outcome.points = frame.points;
  outcome.weight = frame.weight;
  outcome.size.reserve(frame.points.size());
  for (const cv::KeyPoint& point : frame.features.key_points) {
    outcome.size.push_back(point.size);
  }
  outcome.tracking = times.measure("track", [&] {
    return tracker_.track(std::move(frame), [this](const Frame& lost) { return relocalize(lost); });
  });
  if (outcome.tracking.failure == TrackingFailure::kNone) {
    log_.add(image.timestamp, outcome.tracking.camera_from_world, outcome.tracking.reference,
             tracker_.map());
    filter_.setPose(image.timestamp, outcome.tracking.camera_from_world);
  }
  outcome.map_moved =
      times.measure("map", [&] { return exchangeWithThreads(outcome.tracking.new_key_frame); });
  if (outcome.map_moved && tracker_.lastFrame() != nullptr) {
    filter_.setPose(tracker_.lastFrame()->timestamp, tracker_.lastFrame()->camera_from_world);
  }
  return outcome;
}

void Pipeline::finish() {
  takeUp(kLocalMapping, [this] { return mapper_.finish(); });
  bool more = true;
  while (more) {  // after an error as well: what threw is over and done with
    bool failed = true;
    const bool moved = takeUp(kLoopClosing, [&] {
      std::optional<MapCorrection> correction = loops_.finish(tracker_.map());
      failed = false;
      return correction;
    });
    more = moved || failed;
  }
}

}  // namespace hmcdyn::slam

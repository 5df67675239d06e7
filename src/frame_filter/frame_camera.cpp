// SPDX-License-Identifier: BSD-3-Clause
#include "frame_filter/frame_camera.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#include <opencv2/core.hpp>

#include "regions/frame_regions.hpp"
#include "two_view/camera_motion.hpp"

namespace hmcdyn::internal {
namespace {

/// How far a point may be from where a predicted motion puts it (px): two standard deviations of
/// what a hand adds to a constant velocity within 1/30 s (7 mrad, as measured on five recordings of
/// TUM's fr3, at a focal length of 530 px).
constexpr float kMotionUncertainty = 8.0f;

bool inAnyRegion(const DynamicFeatureFilterInput& input, std::size_t i) {
  return std::any_of(
      input.regions.boxes.begin(), input.regions.boxes.end(),
      [&](const DetectionBox& box) { return box.contains(input.points.u[i], input.points.v[i]); });
}

/// Whether the matches determine what the camera did: they are of the background, or known to be at
/// rest (not just not known to move), and no other matrix fits them as well.
bool isDetermined(const TwoViewEstimate& motion) {
  if (motion.verdict == FundamentalVerdict::kCameraStill) {  // nine of ten do not agree by chance
    return true;
  }
  const bool at_rest =
      motion.source == MatchSource::kBackground || motion.source == MatchSource::kAtRest;
  return at_rest && motion.model.kind != TwoViewModelKind::kNone &&
         (motion.model.kind != TwoViewModelKind::kFundamental || motion.fundamentalDefined());
}

/// Who may speak for a predicted motion: what lies outside the boxes or is known to be at rest;
/// where that is too little, all that is not known to move.
std::vector<std::uint8_t> speakersFor(const PointPairsView& pairs,
                                      const std::vector<KnownMotion>& known,
                                      const DynamicFeatureFilterInput& input,
                                      const DynamicFeatureFilterOptions& options) {
  std::vector<std::uint8_t> speaks(pairs.size(), 0);
  int number = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const bool at_rest = !known.empty() && known[i] == KnownMotion::kAtRest;
    speaks[i] = at_rest || !inAnyRegion(input, i) ? 1 : 0;
    const bool counts =
        speaks[i] != 0 && hasDepth(input.points.depth[i]) && !std::isnan(pairs.earlier_u[i]);
    number += counts ? 1 : 0;
  }
  if (number < 2 * options.two_view.min_matches) {
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      speaks[i] = known.empty() || known[i] != KnownMotion::kMoving ? 1 : 0;
    }
  }
  return speaks;
}

/// The predicted motion, made exact; nothing where it does not hold.
std::optional<CameraMotion> exactMotion(const EarlierFrame& frame, const PointPairsView& pairs,
                                        const std::vector<std::uint8_t>& speaks,
                                        const DynamicFeatureFilterInput& input,
                                        const DynamicFeatureFilterOptions& options) {
  const std::optional<CameraMotion> motion =
      fitCameraMotion(input.camera, pairs, input.points.depth, speaks, *frame.current_from_earlier,
                      kMotionUncertainty, options.two_view);
  constexpr double kLeastShare = 0.25;  // of those who may speak: fewer agree with any motion
  const bool holds =
      motion && motion->inliers >= static_cast<std::size_t>(options.two_view.min_matches) &&
      static_cast<double>(motion->inliers) >= kLeastShare * static_cast<double>(motion->points);
  return holds ? motion : std::nullopt;
}

/// The median of the distances up to a limit (px): the noise of those who agree. NaN without any.
float medianUpTo(float limit, const std::vector<float>& distance,
                 const std::vector<std::uint8_t>& counts) {
  std::vector<float> agreeing;
  for (std::size_t i = 0; i < distance.size(); ++i) {
    if (counts[i] != 0 && distance[i] <= limit) {
      agreeing.push_back(distance[i]);
    }
  }
  if (agreeing.empty()) {
    return kNaN;
  }
  const auto middle = agreeing.begin() + static_cast<std::ptrdiff_t>(agreeing.size() / 2);
  std::nth_element(agreeing.begin(), middle, agreeing.end());
  return *middle;
}

/// What a motion is worth as an estimate. @param model of the motion.
TwoViewEstimate estimateOf(const TwoViewModel& model, const CameraMotion& motion,
                           const PointPairsView& pairs, const std::vector<std::uint8_t>& speaks,
                           const DynamicFeatureFilterOptions& options) {
  TwoViewEstimate estimate;
  estimate.source = MatchSource::kPrediction;
  estimate.model = model;
  estimate.verdict = estimate.model.kind == TwoViewModelKind::kFundamental
                         ? FundamentalVerdict::kDefined
                         : FundamentalVerdict::kIllConditioned;
  estimate.matches = motion.points;
  estimate.inliers = motion.inliers;
  estimate.median_distance = medianUpTo(2.0f * options.two_view.inlier_threshold,
                                        modelDistances(estimate.model, pairs), speaks);
  return estimate;
}

}  // namespace

void estimateCamera(const EarlierFrame& frame, const PointPairsView& pairs,
                    const std::vector<KnownMotion>& known, const DynamicFeatureFilterInput& input,
                    const DynamicFeatureFilterOptions& options, EarlierFrameReport& report) {
  const bool is_predicted = options.require_known_camera && frame.current_from_earlier &&
                            input.camera.fx > 0.0 && input.camera.fy > 0.0;
  const std::vector<std::uint8_t> speaks =
      is_predicted ? speakersFor(pairs, known, input, options) : std::vector<std::uint8_t>();
  const std::optional<CameraMotion> motion =
      is_predicted ? exactMotion(frame, pairs, speaks, input, options) : std::nullopt;
  const TwoViewModel predicted =
      motion ? modelOfMotion(input.camera, motion->current_from_earlier) : TwoViewModel();
  report.motion =
      estimateTwoViewModel(pairs, input.regions.boxes, known, options.two_view, predicted);
  report.camera_known = isDetermined(report.motion);
  if (!motion) {
    return;
  }
  report.current_from_earlier = Pose(motion->current_from_earlier);
  // Only where the matches do not determine a model: a prediction made exact by few points is worse
  // than F of those who are known to be at rest. (Where boxes cover half of the image, too, the
  // error of a real sequence rose from 8.4 to 11.5 mm, and no crowd was saved.)
  if (!report.camera_known) {
    report.motion = estimateOf(predicted, *motion, pairs, speaks, options);
    report.camera_known = true;
  }
}

void forgetOutside(const DynamicFeatureFilterInput& input, std::vector<float>& distance) {
  for (std::size_t i = 0; i < distance.size(); ++i) {
    if (!inAnyRegion(input, i)) {
      distance[i] = kNaN;
    }
  }
}

}  // namespace hmcdyn::internal

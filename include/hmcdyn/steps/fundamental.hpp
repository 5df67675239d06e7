// SPDX-License-Identifier: BSD-3-Clause
// Step 2: the camera's motion between two frames, and whether it defines epipolar lines. [OpenCV]
#pragma once

#include <cstddef>
#include <cstdint>

#include <hmcdyn/detail/requirements.hpp>
#include <hmcdyn/steps/epipolar.hpp>
#include <hmcdyn/types.hpp>

namespace hmcdyn {

/// Which matches speak for the camera's motion, and when F counts as defined.
struct TwoViewOptions {
  int min_matches = 12;  ///< Fewer matches than this give no model; at least 8.

  /// The model is estimated from the matches outside every box when there are this many of them ...
  int min_background_matches = 60;
  /// ... and they lie in this many cells of a 4-by-4 grid over all matches; else, under the same
  /// two conditions, from those that are known to be at rest; else from those that are not known to
  /// move; else from all matches.
  int min_background_cells = 5;

  float inlier_threshold = 0.5f;  ///< Distance of an inlier (px).
  double confidence = 0.999;      ///< Of the robust estimators, in (0, 1).
  /// Of the robust estimators: enough, at 98 %, for a consensus of half of the matches; what fewer
  /// agree with says little of the camera.
  int max_iterations = 500;
  std::uint32_t seed = 1;  ///< Of the robust estimators.

  /// The camera stands still when this share of the matches ...
  float still_share = 0.9f;
  /// ... moved by less than this (px).
  float still_displacement = 0.35f;

  /// F is defined when the second smallest singular value of its linear system exceeds the smallest
  /// by this factor: 1 = a second solution fits as well.
  float min_conditioning = 2.0f;
  /// Where F is not defined, a homography replaces it if this share of the matches are its inliers.
  float min_homography_share = 0.6f;
};

/// Whether the matches define a fundamental matrix, and why not.
enum class FundamentalVerdict : std::uint8_t {
  kDefined,         ///< They do.
  kTooFewMatches,   ///< Fewer than min_matches.
  kCameraStill,     ///< Nothing moved.
  kIllConditioned,  ///< The camera only rotated, or the parallax drowns in noise.
  kNoConsensus,     ///< The robust estimator found no matrix.
};

/// "defined", "too few matches", "camera still", "ill-conditioned" or "no consensus".
const char* toString(FundamentalVerdict verdict) noexcept;

/// The matches that spoke for the camera's motion.
enum class MatchSource : std::uint8_t {
  kAll,         ///< Nothing else was enough.
  kBackground,  ///< Those outside every box.
  kAtRest,      ///< Those known to be at rest: the boxes left too little background.
  kNotMoving,   ///< Those not known to move: too few were known to be at rest.
  kPrediction,  ///< A predicted motion, made exact by the points that agree with it.
};

/// The motion model of a frame pair, and what it was made of.
struct TwoViewEstimate {
  TwoViewModel model;  ///< What to measure distances with; kNone only where nothing fits.
  /// Whether F is defined, and why not.
  FundamentalVerdict verdict = FundamentalVerdict::kTooFewMatches;
  MatchSource source = MatchSource::kAll;  ///< What it was estimated from ...
  std::size_t matches = 0;                 ///< ... and how many these are.
  std::size_t inliers = 0;                 ///< Those within inlier_threshold of the model.
  float median_distance = kNaN;  ///< Median distance of these matches (px): the noise of the model.
  float conditioning = 0.0f;     ///< Ratio that min_conditioning refers to; 0 = not computed.

  /// True where `model` is a fundamental matrix that the matches determine. One that they do not
  /// stays the model where no homography explains them either.
  bool fundamentalDefined() const noexcept { return verdict == FundamentalVerdict::kDefined; }
};

/// Whether the matches outside every box are enough for estimateTwoViewModel() to leave the others
/// out.
/// @throws std::invalid_argument as estimateTwoViewModel().
bool backgroundSuffices(const PointPairsView& pairs, Span<const DetectionBox> boxes,
                        const TwoViewOptions& options = {});

/// Estimates what the camera's motion does to the background: a fundamental matrix by MAGSAC
/// (Barath, Noskova, Matas 2019) and a normalised eight-point refit with Sampson weights (Hartley
/// 1997; Luong, Faugeras 1996). A camera that stands still or only rotates leaves F undefined, and
/// epipolar distances would be noise; a homography, or plain displacement, then takes its place.
///
/// @param pairs of N points; those with a NaN are left out.
/// @param boxes whose points are left out while enough others remain.
/// @throws std::invalid_argument when sizes differ or an option is out of range.
TwoViewEstimate estimateTwoViewModel(const PointPairsView& pairs, Span<const DetectionBox> boxes,
                                     const TwoViewOptions& options = {});

/// The same, where earlier frames have shown what moves and what is at rest. That decides where the
/// boxes leave too little, so that a crowd that fills the image is not taken for the world.
///
/// @param known of the N points; empty = nothing is known.
/// @throws std::invalid_argument as above, and when `known` has another size.
TwoViewEstimate estimateTwoViewModel(const PointPairsView& pairs, Span<const DetectionBox> boxes,
                                     Span<const KnownMotion> known, const TwoViewOptions& options);

/// The same, where somebody knows roughly how the camera moved.
///
/// @param predicted a fundamental matrix near the sought one, e.g. modelOfMotion() of a predicted
/// motion: where the majority of the matches agree with what the refit makes of it, nothing is
/// drawn at random, which is most of the time that this takes. A model of another kind = none.
/// @throws std::invalid_argument as above.
TwoViewEstimate estimateTwoViewModel(const PointPairsView& pairs, Span<const DetectionBox> boxes,
                                     Span<const KnownMotion> known, const TwoViewOptions& options,
                                     const TwoViewModel& predicted);

}  // namespace hmcdyn

// SPDX-License-Identifier: BSD-3-Clause
// The camera's motion between two frames, from a prediction and the points that may speak for it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include <hmcdyn/dynamic_feature_filter.hpp>
#include <hmcdyn/steps/epipolar.hpp>
#include <hmcdyn/types.hpp>

namespace hmcdyn::internal {

/// A prediction made exact: where it puts a point is wrong by pixels, where the points themselves
/// say by fractions of one.
struct CameraMotion {
  Eigen::Isometry3d current_from_earlier = Eigen::Isometry3d::Identity();
  std::size_t points = 0;   ///< That spoke.
  std::size_t inliers = 0;  ///< Those within twice TwoViewOptions::inlier_threshold of it.
};

/// Fits the motion to the pixels of points with depth: Gauss-Newton on SE(3) with a Geman-McClure
/// kernel that narrows from the prediction's uncertainty to the noise of a match, so that what
/// moves otherwise has no say, were it the majority.
/// @param pairs of N points, NaN in the earlier frame = no match. @param depth N depths in the
/// current frame (m). @param may_speak N flags.
/// @param predicted of the motion. @param uncertainty of a predicted pixel (px).
/// @return nothing where fewer than min_matches points speak, or the fit does not hold.
std::optional<CameraMotion> fitCameraMotion(const PinholeCamera& camera,
                                            const PointPairsView& pairs, Span<const float> depth,
                                            Span<const std::uint8_t> may_speak,
                                            const Eigen::Isometry3d& predicted, float uncertainty,
                                            const TwoViewOptions& options);

}  // namespace hmcdyn::internal

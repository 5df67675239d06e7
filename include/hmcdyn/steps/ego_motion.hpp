// SPDX-License-Identifier: BSD-3-Clause
// Step 3, the other distance: compensated for the camera's known motion, in three dimensions.
#pragma once

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <hmcdyn/detail/requirements.hpp>
#include <hmcdyn/steps/epipolar.hpp>
#include <hmcdyn/types.hpp>

namespace hmcdyn {

/// How depth counts in egoMotionDistances.
struct EgoMotionOptions {
  /// Virtual stereo baseline times focal length (px m). It turns depths into disparities, so that a
  /// motion along the ray counts in pixels too, and by as much as the sensor's noise allows: the
  /// noise of a structured-light sensor is about constant in disparity. 0 = ignore depth changes.
  float baseline_fx = 40.0f;
};

/// How far each key point moved (px) after the camera's motion is taken out: the point of the
/// earlier frame, with its depth there, is taken into the current frame by the camera's motion, and
/// compared with where it is seen: norm of (du, dv, d disparity).
///
/// A thing that moves along the epipolar line is invisible to eq. 4 but not to this distance; in
/// exchange the motion has to be known (from odometry, or from the background's points).
///
/// @param earlier_depth N depths (m) in the earlier frame, at the earlier pixels.
/// @param current_depth N depths (m) in the current frame.
/// @param current_from_earlier motion that takes points from the earlier camera's frame to the
/// current one's.
/// @return N distances; NaN without a match or without the earlier depth, or where the point would
/// be behind the camera. Without a current depth the disparity is left out.
/// @throws std::invalid_argument when sizes differ, or baseline_fx is negative or not finite.
inline std::vector<float> egoMotionDistances(
    const PinholeCamera& camera, const Eigen::Isometry3d& current_from_earlier,
    const PointPairsView& pairs, Span<const float> earlier_depth, Span<const float> current_depth,
    const EgoMotionOptions& options = {}, std::vector<float> reuse = {}) {
  checkPointPairs(pairs);
  if (earlier_depth.size() != pairs.size() || current_depth.size() != pairs.size()) {
    throw std::invalid_argument("egoMotionDistances: " + std::to_string(pairs.size()) +
                                " pairs, but " + std::to_string(earlier_depth.size()) +
                                " earlier and " + std::to_string(current_depth.size()) +
                                " current depths; expected equal sizes");
  }
  if (!(options.baseline_fx >= 0.0f) || !std::isfinite(options.baseline_fx)) {
    throw std::invalid_argument("egoMotionDistances: baseline_fx is " +
                                std::to_string(options.baseline_fx) +
                                "; expected a finite value >= 0 (px m)");
  }
  reuse.assign(pairs.size(), kNaN);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (!hasDepth(earlier_depth[i]) || !std::isfinite(pairs.earlier_u[i]) ||
        !std::isfinite(pairs.earlier_v[i])) {
      continue;
    }
    const Eigen::Vector3d expected =
        current_from_earlier *
        camera.unproject(pairs.earlier_u[i], pairs.earlier_v[i], earlier_depth[i]);
    if (expected.z() <= 0.0) {
      continue;
    }
    const Eigen::Vector2d pixel = camera.project(expected);
    const double du = pixel.x() - pairs.current_u[i];
    const double dv = pixel.y() - pairs.current_v[i];
    const double dd = hasDepth(current_depth[i])
                          ? options.baseline_fx * (1.0 / expected.z() - 1.0 / current_depth[i])
                          : 0.0;
    const double distance = std::sqrt(du * du + dv * dv + dd * dd);
    if (distance <=
        static_cast<double>(std::numeric_limits<float>::max())) {  // not NaN or infinite
      reuse[i] = static_cast<float>(distance);
    }
  }
  return reuse;
}

}  // namespace hmcdyn

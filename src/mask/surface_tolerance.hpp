// SPDX-License-Identifier: BSD-3-Clause
// By how much the depths of one surface may differ between two frames.
#pragma once

#include <vector>

#include "mask/model.hpp"
#include "mask/small_frame.hpp"

namespace hmcdyn::internal {

/// Depths z of one surface in two frames differ by less (m): offset + linear z + quadratic z^2.
struct SurfaceTolerance {
  float offset = 0.0f;
  float linear = 0.0f;
  float quadratic = 0.0f;
  float at(float z) const { return offset + (linear + quadratic * z) * z; }
};

/// How much larger than its model the noise of two frames is: what the camera's driver smooths,
/// what poses and the pixel grid add, and what the model does not know is in the depths of surfaces
/// that were believed to be static. A low quantile speaks, so that those that do move hardly count.
/// @param motion takes points of the frame to the earlier one. @param errors room for them.
/// @return a factor, bounded; 1 where too few surfaces can be compared.
float measuredNoise(const SmallFrame& frame, const SmallFrame& earlier, const SmallCamera& camera,
                    const RelativePose& motion, const MaskModel& model, std::vector<float>& errors);

/// @param noise factor on the model's, of measuredNoise().
SurfaceTolerance surfaceTolerance(const MaskModel& model, float noise);

}  // namespace hmcdyn::internal

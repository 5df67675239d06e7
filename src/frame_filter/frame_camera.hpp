// SPDX-License-Identifier: BSD-3-Clause
// Step 2 of a frame: who knows how the camera moved.
#pragma once

#include <vector>

#include <hmcdyn/dynamic_feature_filter.hpp>

namespace hmcdyn::internal {

/// The two-view model; where the matches determine none, that of the predicted motion, where there
/// is one.
/// @param known of the N points; empty = nothing is known. @param report gets `motion`,
/// `camera_known` and `current_from_earlier`.
void estimateCamera(const EarlierFrame& frame, const PointPairsView& pairs,
                    const std::vector<KnownMotion>& known, const DynamicFeatureFilterInput& input,
                    const DynamicFeatureFilterOptions& options, EarlierFrameReport& report);

/// A model of which nobody knows what it is of says nothing about the points outside all boxes.
void forgetOutside(const DynamicFeatureFilterInput& input, std::vector<float>& distance);

}  // namespace hmcdyn::internal

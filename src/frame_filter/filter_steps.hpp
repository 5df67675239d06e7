// SPDX-License-Identifier: BSD-3-Clause
// filterDynamicFeatures() in its two parts, between which FrameFilter asks the motion mask.
#pragma once

#include <cstdint>

#include <hmcdyn/dynamic_feature_filter.hpp>
#include <hmcdyn/span.hpp>

#include "regions/frame_regions.hpp"

namespace hmcdyn::internal {

/// @throws std::invalid_argument as filterDynamicFeatures().
void checkInput(const DynamicFeatureFilterInput& input, const DynamicFeatureFilterOptions& options);

/// Steps 1 to 7: each point by its own distance. No beliefs yet.
/// @param input checked. @param regions, in_region of its points.
DynamicFeatureFilterResult judgeByDistance(const DynamicFeatureFilterInput& input,
                                           const FrameRegions& regions,
                                           Span<const std::uint8_t> in_region,
                                           const DynamicFeatureFilterOptions& options,
                                           DynamicFeatureFilterWorkspace& workspace);

/// The points vote on each other, by the surfaces that judgeByDistance() left in the workspace. A
/// result of which no beliefs are formed (use_belief, another rule, no depth image) stays as it is.
/// @param is_open N flags, 0 for points that somebody else has judged; empty = none are.
DynamicFeatureFilterResult judgeByBelief(DynamicFeatureFilterResult result,
                                         const DynamicFeatureFilterInput& input,
                                         Span<const std::uint8_t> in_region,
                                         Span<const std::uint8_t> is_open,
                                         const DynamicFeatureFilterOptions& options,
                                         DynamicFeatureFilterWorkspace& workspace);

}  // namespace hmcdyn::internal

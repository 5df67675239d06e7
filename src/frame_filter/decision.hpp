// SPDX-License-Identifier: BSD-3-Clause
// From what the filter found out about points to what a front end does with them.
#pragma once

#include <cstdint>
#include <vector>

#include <hmcdyn/frame_filter.hpp>
#include <hmcdyn/span.hpp>

namespace hmcdyn::internal {

/// Flags, weights and reasons by the filter's labels.
/// @param seen what the motion mask says of the N points, which `details` know already; empty = no
/// mask. @param in_region N flags.
FrameFilterResult decide(DynamicFeatureFilterResult details, std::vector<MaskLabel> seen,
                         Span<const std::uint8_t> in_region, const FrameFilterOptions& options);

/// @param is_first there is no earlier frame to compare with.
FrameFilterStatus statusOf(const DynamicFeatureFilterResult& details, FilterRule rule,
                           bool is_first);

/// Drops the points in regions: nothing tells whether they move.
void dropRegions(Span<const std::uint8_t> in_region, FrameFilterResult& result);

/// min_kept, and the counts of what is kept.
FrameFilterResult keepEnough(FrameFilterResult result, const FrameFilterOptions& options);

}  // namespace hmcdyn::internal

// SPDX-License-Identifier: BSD-3-Clause
// Steps 1 to 3: where the key points were, what the camera did, how far each is from where it
// should be.
#pragma once

#include <cstdint>
#include <vector>

#include <hmcdyn/dynamic_feature_filter.hpp>
#include <hmcdyn/span.hpp>

#include "flow/flow_selection.hpp"

namespace hmcdyn::internal {

/// A frame against the earlier ones.
struct FrameComparison {
  FlowSelection followed;                   ///< The points that flow followed.
  std::vector<EarlierFrameReport> earlier;  ///< One an earlier frame.
  std::vector<float> distance;              ///< N distances (px), the largest; NaN = none.
};

/// Whether the points vote on each other.
bool formsBeliefs(const DynamicFeatureFilterInput& input,
                  const DynamicFeatureFilterOptions& options);

/// Finds the points' surfaces first, where beliefs are formed; they stay in the workspace.
/// @param input checked; its boxes are where to look for motion. @param in_region N flags.
FrameComparison compareFrames(const DynamicFeatureFilterInput& input,
                              Span<const std::uint8_t> in_region,
                              const DynamicFeatureFilterOptions& options,
                              DynamicFeatureFilterWorkspace& workspace);

}  // namespace hmcdyn::internal

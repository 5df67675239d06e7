// SPDX-License-Identifier: BSD-3-Clause
// Surfaces that are no longer where they were.
#pragma once

#include <cstdint>

#include <hmcdyn/motion_mask.hpp>

#include "mask/evidence.hpp"
#include "mask/model.hpp"
#include "mask/small_frame.hpp"
#include "mask/surface_tolerance.hpp"

namespace hmcdyn::internal {

/// Where the frame sees through the place of an earlier surface, that surface has left. The thing
/// it is part of is the one beside the place at the surface's depth, and gets the evidence: of a
/// wide thing that moves across, the leading edge shows free space and the trailing edge this.
/// @param bit of the earlier frame among the comparisons.
void addDepartures(const SmallFrame& frame, const SmallCamera& camera, const SmallFrame& earlier,
                   std::uint8_t bit, const SurfaceTolerance& tolerance, const MaskModel& model,
                   EvidenceImage& image);

}  // namespace hmcdyn::internal

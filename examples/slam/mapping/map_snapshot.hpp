// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "slam/loop/loop_closer.hpp"
#include "slam/loop/loop_key_frame.hpp"
#include "slam/mapping/map.hpp"

namespace hmcdyn::slam {

// Copies of parts of the map for the loop thread, and the way back.

/// The key points of a frame that are believed static: those with a trusted map point, and those
/// outside people that the filter calls static. Without a number or covisibility.
LoopKeyFrame makeLoopKeyFrame(const Frame& frame);

/// A key frame of the map, with what it shares with others.
LoopKeyFrame makeLoopKeyFrame(const Map& map, int key_frame);

/// A loop whose ends may have been culled since, told between the key frames that they hang on.
/// None where both hang on one.
std::optional<LoopConstraint> survivingLoop(const Map& map, const LoopConstraint& loop);

/// The map as loop closing needs it: all key frames and points; sightings of trusted points only.
/// @param loops between key frames that were not culled, see survivingLoop().
LoopSnapshot makeLoopSnapshot(const Map& map, const std::vector<LoopConstraint>& loops);

/// What a closed loop means for the map.
MapCorrection toCorrection(const LoopSnapshot& snapshot, const LoopClosure& closure);

}  // namespace hmcdyn::slam

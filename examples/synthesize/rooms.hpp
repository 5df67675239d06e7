// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include <Eigen/Geometry>

#include "synthesize/furniture.hpp"
#include "synthesize/scene.hpp"

namespace hmcdyn::synthesize {

/// The inside of a room (m): where a camera or a person can be.
using RoomBounds = Eigen::AlignedBox3d;

/// An office, 8 m by 6.5 m: a row of desks in the middle with a partition behind them, as in the
/// TUM fr3 sequences; shelves, window, whiteboard and posters at the walls. The middle of the front
/// desks' edge is near (0, 0); the usual camera stands at (0, -2.5) and looks along +y.
/// @param with_occluders boxes, a plant and a broom between that camera and the desks.
RoomBounds furnishOffice(Scene& scene, const Palette& palette, std::uint64_t seed,
                         bool with_occluders = false);

/// The same with blank walls, a plain floor and almost nothing on the desks.
RoomBounds furnishBareOffice(Scene& scene, const Palette& palette, std::uint64_t seed);

/// A hall for motion capture, 7.2 m by 6.4 m, with free floor in the middle, things along the
/// walls, and the broom, cardboard boxes and chair of the paper's own recordings.
RoomBounds furnishHall(Scene& scene, const Palette& palette, std::uint64_t seed);

}  // namespace hmcdyn::synthesize

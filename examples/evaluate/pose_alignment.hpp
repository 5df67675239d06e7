// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "evaluate/alignment.hpp"
#include "evaluate/association.hpp"
#include "evaluate/trajectory.hpp"

namespace hmcdyn::evaluate {

/// The rigid alignment of the estimate's world to the truth's by whole poses: the chordal mean of
/// the rotations (Moakher 2002, "Means and averaging in the group of rotations"), then the mean of
/// the translations. For a map: align() sees positions only, and where those lie near a line they
/// leave the rotation about it open, which turns the map though the trajectory fits.
/// @throws std::invalid_argument as associate() and checkTrajectory() do.
/// @throws std::runtime_error when no pose can be associated.
Alignment alignPoses(const Trajectory& groundtruth, const Trajectory& estimate,
                     const AssociationOptions& options = {});

}  // namespace hmcdyn::evaluate

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "evaluate/association.hpp"
#include "evaluate/trajectory.hpp"

namespace hmcdyn::evaluate {

/// Which other convention the estimate's poses are in. As how it turns between poses tells: its
/// quaternions w first, its poses the world's in the camera, or the ground truth so. As how far it
/// reaches tells: millimetres. Empty where what is read fits, nothing else does much better, or it
/// turns too little. (A quaternion of norm 1 is one in any order of its four numbers.)
/// @throws std::invalid_argument as associate() does.
std::string otherConvention(const Trajectory& groundtruth, const Trajectory& estimate,
                            const AssociationOptions& options = {});

}  // namespace hmcdyn::evaluate

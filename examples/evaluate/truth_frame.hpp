// SPDX-License-Identifier: BSD-3-Clause
// Ground truths that are not the camera's.
#pragma once

#include <Eigen/Geometry>

#include "evaluate/trajectory.hpp"

namespace hmcdyn::evaluate {

/// What a ground truth's poses are of.
enum class TruthFrame {
  kCamera,       ///< The camera; or nobody asks, and the file is taken as it is.
  kBonnMarkers,  ///< The markers on the camera of the BONN RGB-D dynamic dataset.
};

/// Where BONN's camera is in the frame of its markers: T_ros T_m, with the two transforms of the
/// data set's page, https://www.ipb.uni-bonn.de/data/rgbd-dynamic-dataset/ (Palazzolo, Behley,
/// Lottes, Giguere, Stachniss, ReFusion, IROS 2019), where the camera is at T_ros P T_ros T_m for a
/// pose P of the file. The first T_ros turns the whole world, which alignment undoes. T_m has a
/// scale of 1.06, which a rigid body cannot have: its rotation is the nearest one.
Eigen::Isometry3d bonnMarkersFromCamera();

/// The camera's trajectory from a ground truth.
Trajectory ofCamera(Trajectory truth, TruthFrame frame);

}  // namespace hmcdyn::evaluate

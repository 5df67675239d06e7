// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/truth_frame.hpp"

#include <Eigen/Core>
#include <Eigen/SVD>

namespace hmcdyn::evaluate {

Eigen::Isometry3d bonnMarkersFromCamera() {
  Eigen::Matrix3d ros;
  ros << -1, 0, 0, 0, 0, 1, 0, 1, 0;
  Eigen::Matrix3d turn;
  turn << 1.0157, 0.1828, -0.2389, 0.0009, -0.8431, -0.6413, -0.3009, 0.6147, -0.8085;
  const Eigen::Vector3d shift(0.0113, -0.0098, 0.0111);  // m
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(ros * turn,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = svd.matrixU() * svd.matrixV().transpose();
  pose.translation() = ros * shift;
  return pose;
}

Trajectory ofCamera(Trajectory truth, TruthFrame frame) {
  if (frame == TruthFrame::kBonnMarkers) {
    const Eigen::Isometry3d markers_from_camera = bonnMarkersFromCamera();
    for (StampedPose& stamped : truth) {
      stamped.pose = stamped.pose * markers_from_camera;
    }
  }
  return truth;
}

}  // namespace hmcdyn::evaluate

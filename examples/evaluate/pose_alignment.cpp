// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/pose_alignment.hpp"

#include <stdexcept>
#include <vector>

#include <Eigen/SVD>

namespace hmcdyn::evaluate {

Alignment alignPoses(const Trajectory& groundtruth, const Trajectory& estimate,
                     const AssociationOptions& options) {
  checkTrajectory(groundtruth, "ground truth");
  checkTrajectory(estimate, "estimate");
  const std::vector<IndexPair> pairs =
      associate(timestampsOf(groundtruth), timestampsOf(estimate), options);
  if (pairs.empty()) {
    throw std::runtime_error("no pose of the estimate has a ground-truth pose near in time");
  }
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const IndexPair& pair : pairs) {
    sum += groundtruth[pair.first].pose.linear() * estimate[pair.second].pose.linear().transpose();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs = Eigen::Vector3d::Ones();
  signs.z() = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  Alignment alignment;
  alignment.rotation = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  for (const IndexPair& pair : pairs) {
    alignment.translation += (groundtruth[pair.first].pose.translation() -
                              alignment.rotation * estimate[pair.second].pose.translation()) /
                             static_cast<double>(pairs.size());
  }
  return alignment;
}

}  // namespace hmcdyn::evaluate

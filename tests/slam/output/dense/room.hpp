// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

#include "slam/output/dense/fusion.hpp"

namespace hmcdyn::test {

/// 64 x 48 pixels.
inline PinholeCamera smallCamera() { return {60.0, 60.0, 31.5, 23.5}; }

/// What a camera sees that looks straight at a wall z m away, in one colour, every pixel kept.
inline slam::ThinnedKeyFrame wallAt(double z, const cv::Scalar& bgr = {30, 20, 10}) {
  slam::ThinnedKeyFrame frame;
  frame.depth = cv::Mat(48, 64, CV_16UC1, cv::Scalar(1000.0 * z));
  frame.usable = cv::Mat(48, 64, CV_8UC1, cv::Scalar(255));
  frame.colour = cv::Mat(48, 64, CV_8UC3, bgr);
  return frame;
}

/// The same with a person 1 m away in these pixels, found by the detector or not.
inline slam::ThinnedKeyFrame wallWithPerson(double z, const cv::Rect& person, bool is_masked) {
  slam::ThinnedKeyFrame frame = wallAt(z);
  frame.depth(person).setTo(1000);
  if (is_masked) {
    frame.usable(person).setTo(0);
  }
  return frame;
}

/// A camera at (x, y, z) that looks along the world's z axis.
inline Eigen::Isometry3d lookingAlongZ(double x, double y, double z) {
  Eigen::Isometry3d camera_from_world = Eigen::Isometry3d::Identity();
  camera_from_world.translation() = Eigen::Vector3d(-x, -y, -z);
  return camera_from_world;
}

/// Points nearer than 1.5 m to the world's origin plane: the person's.
inline int pointsOfPerson(const slam::PointCloud& cloud) {
  int count = 0;
  for (const Eigen::Vector3f& point : cloud.position) {
    count += point.z() < 1.5f ? 1 : 0;
  }
  return count;
}

}  // namespace hmcdyn::test

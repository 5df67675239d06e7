// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include <hmcdyn/depth_error.hpp>
#include <hmcdyn/types.hpp>

namespace hmcdyn::slam {

/// What loop closing and relocalisation need of a key frame: a copy, with only those key points
/// that are believed static.
struct LoopKeyFrame {
  std::size_t id = 0;
  double timestamp = 0.0;  ///< (s)
  Eigen::Isometry3d camera_from_world = Eigen::Isometry3d::Identity();
  cv::Mat descriptors;         ///< N x 32, CV_8U. Shared, not copied: nobody may write to it.
  KeyPoints points;            ///< N pixels with depths.
  std::vector<float> sigma;    ///< N standard deviations of a pixel coordinate (px).
  std::vector<int> map_point;  ///< N map points, or -1.
  std::vector<std::pair<std::size_t, int>>
      covisible;  ///< Key frames and how many points they share.
};

/// @param argument what the messages call it.
/// @throws std::invalid_argument unless descriptors, points, sigma and map_point agree in size, the
///   descriptors are of 32 bytes, and each sigma is positive and finite.
void checkLoopKeyFrame(const LoopKeyFrame& key_frame, const char* argument);

/// Standard deviation (m) of the difference of two measured depths of one point; 1 where there is
/// no depth.
inline float sigmaOfDifference(float depth, const DepthErrorModel& model) {
  return hasDepth(depth) ? std::sqrt(2.0f) * relativeDepthError(depth, model) : 1.0f;
}

}  // namespace hmcdyn::slam

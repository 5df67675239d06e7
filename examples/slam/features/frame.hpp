// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include <hmcdyn/depth_error.hpp>
#include <hmcdyn/types.hpp>

#include "slam/features/orb_extractor.hpp"

namespace hmcdyn::slam {

/// "No map point": what a key point without one refers to.
inline constexpr int kNoMapPoint = -1;

/// Where the motion before a frame puts its camera.
struct PosePrior {
  Eigen::Isometry3d camera_from_world = Eigen::Isometry3d::Identity();
  Eigen::Matrix<double, 6, 6> covariance;  ///< As MotionPrediction has it.
};

/// A frame on its way through the tracker: what was seen, what the filter said, and where it is.
struct Frame {
  std::size_t index = 0;
  double timestamp = 0.0;               ///< (s)
  cv::Size size;                        ///< Of the image (px).
  Features features;                    ///< N ORB key points with descriptors.
  KeyPoints points;                     ///< The same N, with depth.
  std::vector<float> sigma;             ///< N standard deviations of a pixel (px), by octave.
  std::vector<float> depth_spread;      ///< N: how far depths beside the point differ (m).
  std::vector<PointLabel> label;        ///< N verdicts of the filter.
  std::vector<float> lambda;            ///< N weights of eq. 7, for map and beliefs.
  std::vector<float> weight;            ///< N weights for the refinement: lambda, or 0 and 1.
  std::vector<std::uint8_t> in_person;  ///< N flags: of a person, or of a thing that moved before.
  bool soft_weights = false;            ///< The 0.6 rule: eq. 7's weights, or 0 and 1 only.

  Eigen::Isometry3d camera_from_world = Eigen::Isometry3d::Identity();
  /// Where the filter's own odometry puts the camera; none where it does not know.
  std::optional<Eigen::Isometry3d> odometry;
  std::optional<PosePrior> prior;  ///< None where the motion model knows nothing, or was wrong.
  std::vector<int> map_point;      ///< N map points, or kNoMapPoint.
  bool tracked = false;            ///< camera_from_world is a measurement.
  std::size_t inliers = 0;         ///< Map points that agree with it.
};

/// Depth (m) at key points, the nearest pixel's; where that has none, the median of its eight
/// neighbours that have one, provided they agree within 5 %; else 0.
std::vector<float> depthAtKeyPoints(const cv::Mat& depth,
                                    const std::vector<cv::KeyPoint>& key_points);

/// Half the range of depths (m) within 2 px of key points. Colour and depth are registered no
/// better than that, so a depth beside an edge may be that of the other side. 0 where there is no
/// depth.
std::vector<float> depthSpreadAtKeyPoints(const cv::Mat& depth,
                                          const std::vector<cv::KeyPoint>& key_points);

/// Standard deviations (m) of the depths of key points that are used together, against what other
/// views of the same points measured; 1 where there is none. What is wrong with a depth its
/// neighbours share (on a Kinect, at 50 px half of what they share at 10 px): n depths in a square
/// of 100 px say together what one of them says. Depths beside an edge may be that of the other
/// side.
std::vector<float> depthSigmas(const Frame& frame, const std::vector<std::size_t>& key_points,
                               const DepthErrorModel& model);

/// A measured depth (m) without the systematic error of its point: z, where z + offset z^2 was
/// measured (offset in 1/m, see BundleProblem).
float withoutOffset(float measured, double offset);

/// A frame of features, not yet filtered or tracked: every point static, weight 1.
/// @param depth CV_32FC1 (m), 0 = none.
Frame makeFrame(std::size_t index, double timestamp, Features features, const cv::Mat& depth,
                float scale_factor);

}  // namespace hmcdyn::slam

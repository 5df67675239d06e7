// SPDX-License-Identifier: BSD-3-Clause
#include "calibrate/depth_samples.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace hmcdyn::calibrate {
namespace {

bool atEdge(const cv::Mat& depth, double u, double v, double jump) {
  constexpr int kRadius = 2;
  const cv::Rect window(cvRound(u) - kRadius, cvRound(v) - kRadius, 2 * kRadius + 1,
                        2 * kRadius + 1);
  if ((window & cv::Rect(0, 0, depth.cols, depth.rows)) != window) {
    return true;
  }
  double low = 0.0;
  double high = 0.0;
  cv::minMaxLoc(depth(window), &low, &high);
  return low <= 0.0 || high - low > jump * low;
}

/// Velocity of a point in the camera's frame around an image: from the images before and after.
Eigen::Vector3d velocityOf(const Eigen::Vector3d& point,
                           const std::vector<CalibrationImage>& images, const ImagePoses& poses,
                           std::size_t image) {
  std::size_t first = image;
  std::size_t last = image;
  if (image > 0 && poses[image - 1]) {
    first = image - 1;
  }
  if (image + 1 < poses.size() && poses[image + 1]) {
    last = image + 1;
  }
  const double time = images[last].timestamp - images[first].timestamp;
  if (!(time > 0.0)) {
    return Eigen::Vector3d::Zero();
  }
  return (poses[last]->inverse() * point - poses[first]->inverse() * point) / time;
}

}  // namespace

std::vector<DepthSample> depthSamples(const std::vector<CalibrationImage>& images,
                                      const Triangulation& triangulation,
                                      const PinholeCamera& camera, const SampleOptions& options) {
  std::vector<DepthSample> samples;
  for (const TriangulatedTrack& track : triangulation.tracks) {
    for (const TrackPoint& seen : track.seen) {
      const auto image = static_cast<std::size_t>(seen.image);
      const Eigen::Isometry3d camera_from_world = triangulation.poses[image]->inverse();
      const Eigen::Vector3d p = camera_from_world * track.point;
      const Eigen::Vector3d axis = camera_from_world.linear().row(2);
      DepthSample sample;
      sample.track = track.track;
      sample.image = seen.image;
      sample.u = static_cast<double>(seen.pixel.x);
      sample.v = static_cast<double>(seen.pixel.y);
      sample.measured = static_cast<double>(depthAt(images[image].depth, sample.u, sample.v));
      sample.truth = p.z();
      sample.sigma = std::sqrt(std::max(0.0, axis.dot(track.covariance * axis)));
      if (!(sample.measured > 0.0) || !(sample.truth > 0.0) ||
          !(sample.sigma < options.largest_sigma * sample.truth)) {
        continue;
      }
      const Eigen::Vector3d velocity = velocityOf(track.point, images, triangulation.poses, image);
      sample.flow_u = camera.fx * (velocity.x() - p.x() / p.z() * velocity.z()) / p.z();
      sample.flow_v = camera.fy * (velocity.y() - p.y() / p.z() * velocity.z()) / p.z();
      sample.approach = velocity.z();
      sample.at_edge = atEdge(images[image].depth, sample.u, sample.v, options.edge_jump);
      samples.push_back(sample);
    }
  }
  return samples;
}

}  // namespace hmcdyn::calibrate

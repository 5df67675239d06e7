// SPDX-License-Identifier: BSD-3-Clause
#include "slam/tracking/frame.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace hmcdyn::slam {
namespace {

/// Median of the neighbours' depths where there are three or more, within 5 % of it; else 0.
float depthFromNeighbours(const cv::Mat& depth, int column, int row) {
  std::vector<float> found;
  for (int dv = -1; dv <= 1; ++dv) {
    for (int du = -1; du <= 1; ++du) {
      const int u = column + du;
      const int v = row + dv;
      if ((du != 0 || dv != 0) && u >= 0 && v >= 0 && u < depth.cols && v < depth.rows &&
          hasDepth(depth.at<float>(v, u))) {
        found.push_back(depth.at<float>(v, u));
      }
    }
  }
  if (found.size() < 3) {
    return 0.0f;
  }
  std::sort(found.begin(), found.end());
  const float median = found[found.size() / 2];
  const bool agree = found.back() - found.front() <= 0.05f * median;
  return agree ? median : 0.0f;
}

}  // namespace

std::vector<float> depthAtKeyPoints(const cv::Mat& depth,
                                    const std::vector<cv::KeyPoint>& key_points) {
  std::vector<float> depths;
  depths.reserve(key_points.size());
  for (const cv::KeyPoint& point : key_points) {
    const int column = std::clamp(cvRound(point.pt.x), 0, depth.cols - 1);
    const int row = std::clamp(cvRound(point.pt.y), 0, depth.rows - 1);
    const float z = depth.at<float>(row, column);
    depths.push_back(hasDepth(z) ? z : depthFromNeighbours(depth, column, row));
  }
  return depths;
}

Frame makeFrame(std::size_t index, double timestamp, Features features, const cv::Mat& depth,
                float scale_factor) {
  Frame frame;
  frame.index = index;
  frame.timestamp = timestamp;
  frame.size = depth.size();
  frame.features = std::move(features);
  const std::size_t n = frame.features.key_points.size();
  const std::vector<float> depths = depthAtKeyPoints(depth, frame.features.key_points);
  frame.points.reserve(n);
  frame.sigma.reserve(n);
  for (std::size_t i = 0; i < n; ++i) {
    const cv::KeyPoint& point = frame.features.key_points[i];
    frame.points.push_back(point.pt.x, point.pt.y, depths[i]);
    frame.sigma.push_back(std::pow(scale_factor, static_cast<float>(point.octave)));
  }
  frame.label.assign(n, PointLabel::kStatic);
  frame.weight.assign(n, 1.0f);
  frame.in_person.assign(n, 0);
  frame.map_point.assign(n, kNoMapPoint);
  return frame;
}

}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#include "slam/features/frame.hpp"

#include <algorithm>
#include <cmath>
#include <map>
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

/// Standard deviation (px) of a key point found at an octave of the pyramid. Residuals of true
/// matches hardly grow with it, since corners are located between pixels: on real video their
/// median is 0.65 px at octave 0 and 0.97 px at octave 7, where the scale alone says 3.6 times as
/// much. Only the ratio counts: the tracker scales all by what a frame's matches show.
float pixelSigma(int octave, float scale_factor) {
  constexpr float kAtAnyOctave = 0.95f;
  constexpr float kOfALevelsPixel = 0.32f;
  return std::hypot(kAtAnyOctave,
                    kOfALevelsPixel * std::pow(scale_factor, static_cast<float>(octave)));
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

std::vector<float> depthSpreadAtKeyPoints(const cv::Mat& depth,
                                          const std::vector<cv::KeyPoint>& key_points) {
  constexpr int kReach = 2;  // px
  std::vector<float> spreads;
  spreads.reserve(key_points.size());
  for (const cv::KeyPoint& point : key_points) {
    const cv::Rect window = cv::Rect(cvRound(point.pt.x) - kReach, cvRound(point.pt.y) - kReach,
                                     2 * kReach + 1, 2 * kReach + 1) &
                            cv::Rect(0, 0, depth.cols, depth.rows);
    float nearest = 0.0f;
    float farthest = 0.0f;
    for (int row = window.y; row < window.y + window.height; ++row) {
      const float* depths = depth.ptr<float>(row);
      for (int column = window.x; column < window.x + window.width; ++column) {
        if (hasDepth(depths[column])) {
          nearest = nearest > 0.0f ? std::min(nearest, depths[column]) : depths[column];
          farthest = std::max(farthest, depths[column]);
        }
      }
    }
    spreads.push_back(0.5f * (farthest - nearest));
  }
  return spreads;
}

std::vector<float> depthSigmas(const Frame& frame, const std::vector<std::size_t>& key_points,
                               const DepthErrorModel& model) {
  constexpr float kSquare = 100.0f;  // px
  const auto squareOf = [&frame](std::size_t i) {
    return std::make_pair(static_cast<int>(frame.points.u[i] / kSquare),
                          static_cast<int>(frame.points.v[i] / kSquare));
  };
  std::map<std::pair<int, int>, float> depths_in;
  for (const std::size_t i : key_points) {
    depths_in[squareOf(i)] += hasDepth(frame.points.depth[i]) ? 1.0f : 0.0f;
  }
  std::vector<float> sigmas;
  sigmas.reserve(key_points.size());
  for (const std::size_t i : key_points) {
    const float depth = frame.points.depth[i];
    sigmas.push_back(hasDepth(depth)
                         ? std::hypot(relativeDepthError(depth, model, depths_in[squareOf(i)]),
                                      frame.depth_spread[i])
                         : 1.0f);
  }
  return sigmas;
}

float withoutOffset(float measured, double offset) {
  // The smaller root of offset z^2 + z - measured, in the form that also holds for offset 0. An
  // offset that no depth could give (beyond -1 / (4 measured)) leaves the vertex.
  const double square = std::max(0.0, 1.0 + 4.0 * offset * measured);
  return static_cast<float>(2.0 * measured / (1.0 + std::sqrt(square)));
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
  frame.depth_spread = depthSpreadAtKeyPoints(depth, frame.features.key_points);
  frame.points.reserve(n);
  frame.sigma.reserve(n);
  for (std::size_t i = 0; i < n; ++i) {
    const cv::KeyPoint& point = frame.features.key_points[i];
    frame.points.push_back(point.pt.x, point.pt.y, depths[i]);
    frame.sigma.push_back(pixelSigma(point.octave, scale_factor));
  }
  frame.label.assign(n, PointLabel::kStatic);
  frame.lambda.assign(n, 1.0f);
  frame.weight.assign(n, 1.0f);
  frame.in_person.assign(n, 0);
  frame.map_point.assign(n, kNoMapPoint);
  return frame;
}

}  // namespace hmcdyn::slam

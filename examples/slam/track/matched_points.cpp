// SPDX-License-Identifier: BSD-3-Clause
#include "slam/track/matched_points.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace hmcdyn::slam {

MatchedPoints::MatchedPoints(const Frame& frame, const std::vector<PointMatch>& matches,
                             const Map& map, MatchPolicy policy) {
  std::vector<std::size_t> key_points;
  key_points.reserve(matches.size());
  for (const PointMatch& match : matches) {
    const MapPoint& point = map.points()[static_cast<std::size_t>(match.map_point)];
    const Eigen::Vector3f position = point.position.cast<float>();
    const float measured = frame.points.depth[match.key_point];
    key_points.push_back(match.key_point);
    x_.push_back(position.x());
    y_.push_back(position.y());
    z_.push_back(position.z());
    u_.push_back(frame.points.u[match.key_point]);
    v_.push_back(frame.points.v[match.key_point]);
    sigma_.push_back(frame.sigma[match.key_point]);
    depth_.push_back(hasDepth(measured) ? withoutOffset(measured, point.depth_offset) : 0.0f);
    weight_.push_back(policy == MatchPolicy::kTrustedPoints ? 1.0f : frame.weight[match.key_point]);
  }
  depth_sigma_ = depthSigmas(frame, key_points, map.options().depth_error);
}

bool MatchedPoints::dropDisagreeingDepths(const PoseRefinementResult& refined,
                                          const PinholeCamera& camera,
                                          const PoseRefinementOptions& options) {
  bool dropped = false;
  for (std::size_t k = 0; k < x_.size(); ++k) {
    if (refined.inlier[k] != 0 || weight_[k] <= 0.0f || !hasDepth(depth_[k])) {
      continue;
    }
    const Eigen::Vector3d p =
        refined.camera_from_world * Eigen::Vector3f(x_[k], y_[k], z_[k]).cast<double>();
    if (p.z() <= options.min_depth) {
      continue;
    }
    const Eigen::Vector2d error =
        (camera.project(p) - Eigen::Vector2d(u_[k], v_[k])) / static_cast<double>(sigma_[k]);
    if (error.squaredNorm() <= options.chi2_two_rows) {
      depth_[k] = 0.0f;
      dropped = true;
    }
  }
  return dropped;
}

double noiseFactor(const Frame& frame, const std::vector<PointMatch>& matches,
                   const Eigen::Isometry3d& camera_from_world, const Map& map) {
  std::vector<double> squares;
  squares.reserve(matches.size());
  for (const PointMatch& match : matches) {
    const Eigen::Vector3d p =
        camera_from_world * map.points()[static_cast<std::size_t>(match.map_point)].position;
    const Eigen::Vector2d seen(frame.points.u[match.key_point], frame.points.v[match.key_point]);
    const double sigma = frame.sigma[match.key_point];
    squares.push_back((map.camera().project(p) - seen).squaredNorm() / (sigma * sigma));
  }
  if (squares.empty()) {
    return 1.0;
  }
  const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
  std::nth_element(squares.begin(), middle, squares.end());
  constexpr double kMedian = 1.386;  // of chi2(2)
  constexpr double kLeast = 0.6;     // few matches by chance
  constexpr double kMost = 2.0;      // more is no noise
  return std::clamp(std::sqrt(*middle / kMedian), kLeast, kMost);
}

}  // namespace hmcdyn::slam

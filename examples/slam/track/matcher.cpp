// SPDX-License-Identifier: BSD-3-Clause
#include "slam/track/matcher.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "slam/features/hamming_distance.hpp"

namespace hmcdyn::slam {
namespace {

const std::uint8_t* descriptorAt(const Frame& frame, std::size_t key_point) {
  return frame.features.descriptors.ptr<std::uint8_t>(static_cast<int>(key_point));
}

/// Pyramid level at which a point should appear from a distance.
int predictLevel(const MapPoint& point, double distance, const MatcherOptions& options) {
  const double level = point.octave + std::log(point.distance / distance) /
                                          std::log(static_cast<double>(options.scale_factor));
  return std::clamp(static_cast<int>(std::lround(level)), 0, options.levels - 1);
}

bool depthAgrees(float measured, double expected, float max_difference) {
  return !hasDepth(measured) ||
         std::abs(measured - expected) <= static_cast<double>(max_difference) * expected;
}

struct Best {
  int distance = std::numeric_limits<int>::max();
  int octave = -1;
  std::size_t key_point = 0;
};

/// The key point that looks most like the map point; distance INT_MAX where none is good enough.
Best findBest(const Frame& frame, const MapPoint& point, const std::vector<std::size_t>& candidates,
              int level, double depth, const MatcherOptions& options) {
  Best best;
  Best second;
  for (const std::size_t i : candidates) {
    const int octave = frame.features.key_points[i].octave;
    if (octave < level - 1 || octave > level + 1 ||
        !depthAgrees(frame.points.depth[i], depth, options.max_depth_difference)) {
      continue;
    }
    const int distance = hammingDistance(point.descriptor.data(), descriptorAt(frame, i));
    if (distance < best.distance) {
      second = best;
      best = {distance, octave, i};
    } else if (distance < second.distance) {
      second = {distance, octave, i};
    }
  }
  const bool ambiguous =
      second.octave == best.octave &&
      static_cast<float>(best.distance) > options.max_ratio * static_cast<float>(second.distance);
  if (best.distance > options.max_distance || ambiguous) {
    best.distance = std::numeric_limits<int>::max();
  }
  return best;
}

/// Keeps the better match where two map points claim one key point.
void claim(std::vector<PointMatch>& by_key_point, const PointMatch& match) {
  PointMatch& held = by_key_point[match.key_point];
  if (held.map_point == kNoMapPoint || match.distance < held.distance) {
    held = match;
  }
}

std::vector<PointMatch> claimed(const std::vector<PointMatch>& by_key_point) {
  std::vector<PointMatch> matches;
  for (const PointMatch& match : by_key_point) {
    if (match.map_point != kNoMapPoint) {
      matches.push_back(match);
    }
  }
  return matches;
}

}  // namespace

KeyPointGrid::KeyPointGrid(const Frame& frame)
    : columns_(std::max(1, static_cast<int>(static_cast<float>(frame.size.width) / kCell) + 1)),
      rows_(std::max(1, static_cast<int>(static_cast<float>(frame.size.height) / kCell) + 1)),
      cells_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)),
      frame_(&frame) {
  for (std::size_t i = 0; i < frame.points.size(); ++i) {
    const int column = std::clamp(static_cast<int>(frame.points.u[i] / kCell), 0, columns_ - 1);
    const int row = std::clamp(static_cast<int>(frame.points.v[i] / kCell), 0, rows_ - 1);
    cells_[static_cast<std::size_t>(row * columns_ + column)].push_back(i);
  }
}

std::vector<std::size_t> KeyPointGrid::within(float u, float v, float radius) const {
  std::vector<std::size_t> found;
  const auto cellOf = [](float x, int count) {
    return std::clamp(static_cast<int>(std::floor(x / kCell)), 0, count - 1);
  };
  for (int row = cellOf(v - radius, rows_); row <= cellOf(v + radius, rows_); ++row) {
    for (int column = cellOf(u - radius, columns_); column <= cellOf(u + radius, columns_);
         ++column) {
      for (const std::size_t i : cells_[static_cast<std::size_t>(row * columns_ + column)]) {
        if (std::abs(frame_->points.u[i] - u) <= radius &&
            std::abs(frame_->points.v[i] - v) <= radius) {
          found.push_back(i);
        }
      }
    }
  }
  return found;
}

ProjectionSearch matchByProjection(const Frame& frame, const KeyPointGrid& grid, const Map& map,
                                   const std::vector<int>& candidates,
                                   const Eigen::Isometry3d& camera_from_world,
                                   const PinholeCamera& camera, float radius,
                                   const MatcherOptions& options, MatchPolicy policy) {
  ProjectionSearch search;
  std::vector<PointMatch> by_key_point(frame.points.size());
  for (const int id : candidates) {
    const MapPoint& point = map.points()[static_cast<std::size_t>(id)];
    const Eigen::Vector3d in_camera = camera_from_world * point.position;
    constexpr double kNearest = 0.1;  // m
    if (in_camera.z() < kNearest) {
      continue;
    }
    const Eigen::Vector2d pixel = camera.project(in_camera);
    if (pixel.x() < 0.0 || pixel.y() < 0.0 || pixel.x() > frame.size.width - 1 ||
        pixel.y() > frame.size.height - 1) {
      continue;
    }
    const double distance = in_camera.norm();
    constexpr double kScaleRange = 2.0;  // seen from much nearer or farther it looks different
    if (distance > kScaleRange * point.distance || point.distance > kScaleRange * distance) {
      continue;
    }
    search.visible.push_back(id);
    const int level = predictLevel(point, distance, options);
    const float window = radius * std::pow(options.scale_factor, static_cast<float>(level));
    const Best best =
        findBest(frame, point,
                 grid.within(static_cast<float>(pixel.x()), static_cast<float>(pixel.y()), window),
                 level, in_camera.z(), options);
    if (best.distance == std::numeric_limits<int>::max()) {
      continue;
    }
    const bool trusted = policy == MatchPolicy::kTrustedPoints &&
                         point.trust.log_odds >= map.options().trust.threshold;
    if (frame.weight[best.key_point] > 0.0f || trusted) {
      claim(by_key_point, {id, best.key_point, best.distance});
    } else {
      search.seen_dynamic.push_back(id);
    }
  }
  search.matches = claimed(by_key_point);
  return search;
}

std::vector<PointMatch> matchByDescriptor(const Frame& frame, const KeyFrame& key_frame,
                                          const MatcherOptions& options) {
  const Frame& other = key_frame.frame;
  std::vector<PointMatch> by_key_point(frame.points.size());
  // What the map point that looks most like each key point looks like, whatever that one prefers.
  std::vector<int> nearest(frame.points.size(), std::numeric_limits<int>::max());
  for (std::size_t j = 0; j < other.points.size(); ++j) {
    if (other.map_point[j] == kNoMapPoint) {
      continue;
    }
    int best = std::numeric_limits<int>::max();
    int second = best;
    std::size_t best_point = 0;
    for (std::size_t i = 0; i < frame.points.size(); ++i) {
      if (frame.weight[i] <= 0.0f) {
        continue;
      }
      const int distance = hammingDistance(descriptorAt(other, j), descriptorAt(frame, i));
      nearest[i] = std::min(nearest[i], distance);
      if (distance < best) {
        second = best;
        best = distance;
        best_point = i;
      } else if (distance < second) {
        second = distance;
      }
    }
    constexpr float kStrictRatio = 0.75f;  // no geometry helps here
    if (best <= options.max_distance &&
        static_cast<float>(best) < kStrictRatio * static_cast<float>(second)) {
      claim(by_key_point, {other.map_point[j], best_point, best});
    }
  }
  for (std::size_t i = 0; i < by_key_point.size(); ++i) {
    if (by_key_point[i].distance > nearest[i]) {  // its own best choice went elsewhere
      by_key_point[i] = {};
    }
  }
  return claimed(by_key_point);
}

}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#include "slam/track/duplicates.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <unordered_set>

namespace hmcdyn::slam {
namespace {

/// Whether a map point projects onto the key point that it was matched with, at its depth.
bool liesOn(const Frame& frame, const PointMatch& match, const Map& map) {
  const MapPoint& point = map.points()[static_cast<std::size_t>(match.map_point)];
  const Eigen::Vector3d in_camera = frame.camera_from_world * point.position;
  const Eigen::Vector2d pixel = map.camera().project(in_camera);
  const double dx = pixel.x() - frame.points.u[match.key_point];
  const double dy = pixel.y() - frame.points.v[match.key_point];
  constexpr double kPixelSigmas = 2.0;
  constexpr double kDepthSigmas = 3.0;
  const double reach = kPixelSigmas * frame.sigma[match.key_point];
  const float depth = frame.points.depth[match.key_point];
  const double depth_reach = kDepthSigmas * depthError(in_camera.z(), map.options().depth_error);
  return dx * dx + dy * dy <= reach * reach &&
         (!hasDepth(depth) || std::abs(depth - in_camera.z()) <= depth_reach);
}

/// Matches points with the key points of a key frame and files what is found there.
void compareWith(int key_frame, const std::vector<int>& points, const Map& map,
                 const DuplicateOptions& options, KnownPoints& known) {
  const Frame& frame = map.keyFrames()[static_cast<std::size_t>(key_frame)].frame;
  const std::unordered_set<int> seen(frame.map_point.begin(), frame.map_point.end());
  std::vector<int> others;
  std::copy_if(points.begin(), points.end(), std::back_inserter(others),
               [&](int point) { return seen.count(point) == 0; });
  const ProjectionSearch search =
      matchByProjection(frame, KeyPointGrid(frame), map, others, frame.camera_from_world,
                        map.camera(), options.radius, options.matcher);
  for (const PointMatch& match : search.matches) {
    if (!liesOn(frame, match, map)) {
      continue;
    }
    const int there = frame.map_point[match.key_point];
    if (there == kNoMapPoint) {
      known.sightings.push_back({match.map_point, key_frame, match.key_point});
      continue;
    }
    const auto observations = [&map](int point) {
      return map.points()[static_cast<std::size_t>(point)].observations.size();
    };
    if (observations(match.map_point) > observations(there)) {
      known.duplicates.emplace_back(there, match.map_point);
    } else {
      known.duplicates.emplace_back(match.map_point, there);
    }
  }
}

}  // namespace

void tieToForgottenPoints(Frame& frame, const KeyPointGrid& grid, const Map& map,
                          const DuplicateOptions& options) {
  std::vector<int> forgotten;
  const int now = static_cast<int>(map.keyFrames().size());
  const std::unordered_set<int> tied(frame.map_point.begin(), frame.map_point.end());
  for (const int point : map.pointsOf(map.nearestKeyFrames(frame.camera_from_world))) {
    const int last_seen = map.points()[static_cast<std::size_t>(point)].last_key_frame;
    if (now - last_seen > options.forgotten_after && tied.count(point) == 0) {
      forgotten.push_back(point);
    }
  }
  const ProjectionSearch search =
      matchByProjection(frame, grid, map, forgotten, frame.camera_from_world, map.camera(),
                        options.radius, options.matcher);
  for (const PointMatch& match : search.matches) {
    int& map_point = frame.map_point[match.key_point];
    if (map_point == kNoMapPoint && liesOn(frame, match, map)) {
      map_point = match.map_point;
    }
  }
}

KnownPoints knownPointsOf(const Map& map, const DuplicateOptions& options) {
  KnownPoints known;
  const int latest = static_cast<int>(map.keyFrames().size()) - 1;
  std::vector<int> neighbours;
  for (const auto& [key_frame, shared] : map.covisible(latest)) {
    if (neighbours.size() >= options.neighbours) {
      break;
    }
    neighbours.push_back(key_frame);
  }
  compareWith(latest, map.pointsOf(neighbours), map, options, known);
  const std::vector<int> own = map.pointsOf({latest});
  for (const int neighbour : neighbours) {
    compareWith(neighbour, own, map, options, known);
  }
  return known;
}

}  // namespace hmcdyn::slam

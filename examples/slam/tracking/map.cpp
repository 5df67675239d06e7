// SPDX-License-Identifier: BSD-3-Clause
#include "slam/tracking/map.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

namespace hmcdyn::slam {
namespace {

Descriptor descriptorOf(const Frame& frame, std::size_t key_point) {
  Descriptor descriptor;
  std::memcpy(descriptor.data(),
              frame.features.descriptors.ptr<std::uint8_t>(static_cast<int>(key_point)),
              descriptor.size());
  return descriptor;
}

Eigen::Vector3d worldPoint(const Frame& frame, std::size_t key_point, const PinholeCamera& camera) {
  return frame.camera_from_world.inverse() * camera.unproject(frame.points.u[key_point],
                                                              frame.points.v[key_point],
                                                              frame.points.depth[key_point]);
}

/// Static beyond doubt: outside people, or clear of the moving person in depth.
bool mayEnterMap(const Frame& frame, std::size_t key_point) {
  constexpr float kClearOfPerson = 0.5f;
  switch (frame.label[key_point]) {
    case PointLabel::kStatic:
      return frame.in_person[key_point] == 0;
    case PointLabel::kSuspect:
      return frame.weight[key_point] > kClearOfPerson;
    case PointLabel::kDynamic:
    case PointLabel::kUnmatched:
      break;
  }
  return false;
}

}  // namespace

double Map::depthInformation(double depth) const {
  const double sigma = options_.depth_noise_floor + options_.depth_noise_quadratic * depth * depth;
  return 1.0 / (sigma * sigma);
}

void Map::count(int point, bool found, bool dynamic) {
  MapPoint& entry = points_[static_cast<std::size_t>(point)];
  ++entry.visible;
  entry.found += found ? 1 : 0;
  entry.seen_dynamic += dynamic ? 1 : 0;
}

void Map::fuse(const Frame& frame, std::size_t key_point, int point) {
  MapPoint& entry = points_[static_cast<std::size_t>(point)];
  const float depth = frame.points.depth[key_point];
  if (hasDepth(depth) && depth <= options_.max_depth) {
    const double information = depthInformation(depth);
    entry.position =
        (entry.information * entry.position + information * worldPoint(frame, key_point, camera_)) /
        (entry.information + information);
    entry.information += information;
  }
  entry.descriptor = descriptorOf(frame, key_point);
  entry.octave = frame.features.key_points[key_point].octave;
  entry.distance = (frame.camera_from_world * entry.position).norm();
  entry.last_key_frame = static_cast<int>(key_frames_.size());
}

int Map::create(const Frame& frame, std::size_t key_point) {
  MapPoint entry;
  entry.position = worldPoint(frame, key_point, camera_);
  entry.information = depthInformation(frame.points.depth[key_point]);
  entry.descriptor = descriptorOf(frame, key_point);
  entry.octave = frame.features.key_points[key_point].octave;
  entry.distance = (frame.camera_from_world * entry.position).norm();
  entry.first_key_frame = static_cast<int>(key_frames_.size());
  entry.last_key_frame = entry.first_key_frame;
  points_.push_back(entry);
  return static_cast<int>(points_.size()) - 1;
}

void Map::insertKeyFrame(Frame frame) {
  KeyFrame key_frame;
  for (std::size_t i = 0; i < frame.points.size(); ++i) {
    int& point = frame.map_point[i];
    const float depth = frame.points.depth[i];
    if (point != kNoMapPoint) {
      fuse(frame, i, point);
    } else if (hasDepth(depth) && depth <= options_.max_depth && mayEnterMap(frame, i)) {
      point = create(frame, i);
    }
    key_frame.map_points += point != kNoMapPoint ? 1 : 0;
  }
  key_frame.frame = std::move(frame);
  key_frames_.push_back(std::move(key_frame));
}

std::vector<int> Map::localPoints() const {
  const int oldest = static_cast<int>(key_frames_.size()) - options_.local_key_frames;
  std::vector<int> local;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (!points_[i].removed && points_[i].last_key_frame >= oldest) {
      local.push_back(static_cast<int>(i));
    }
  }
  return local;
}

void Map::cull() {
  constexpr std::size_t kEnoughToJudge = 5;
  for (MapPoint& point : points_) {
    if (point.removed || point.visible < kEnoughToJudge) {
      continue;
    }
    const auto visible = static_cast<double>(point.visible);
    point.removed = static_cast<double>(point.found) < options_.min_found_share * visible ||
                    static_cast<double>(point.seen_dynamic) > options_.max_dynamic_share * visible;
  }
}

}  // namespace hmcdyn::slam

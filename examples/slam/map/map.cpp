// SPDX-License-Identifier: BSD-3-Clause
#include "slam/map/map.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
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

}  // namespace

void Map::count(int point, bool found, const LandmarkSighting& evidence) {
  if (MapPoint* entry = points_.find(point)) {
    ++entry->visible;
    entry->found += found ? 1 : 0;
    entry->trust.update(evidence, options_.trust);
  }
}

MapPoint Map::describe(const Frame& frame, std::size_t key_point,
                       const Eigen::Vector3d& position) const {
  MapPoint entry;
  entry.position = position;
  entry.descriptor = descriptorOf(frame, key_point);
  entry.octave = frame.features.key_points[key_point].octave;
  entry.distance = (frame.camera_from_world * position).norm();
  entry.trust.log_odds = options_.trust.prior;
  return entry;
}

bool mayEnterMap(const Frame& frame, std::size_t key_point) {
  constexpr float kClearOfPerson = 0.8f;
  switch (frame.label[key_point]) {
    case PointLabel::kStatic:
      return frame.in_person[key_point] == 0;
    case PointLabel::kSuspect:
      return frame.lambda[key_point] > kClearOfPerson;
    case PointLabel::kDynamic:
    case PointLabel::kUnmatched:
      break;
  }
  return false;
}

void Map::addPoint(const Eigen::Vector3d& position, const Observation& first,
                   const Observation& second) {
  const auto seenBy = [this](const Observation& seen) -> int& {
    return key_frames_[static_cast<std::size_t>(seen.key_frame)].frame.map_point[seen.key_point];
  };
  if (seenBy(first) != kNoMapPoint || seenBy(second) != kNoMapPoint) {
    return;
  }
  MapPoint entry = describe(key_frames_[static_cast<std::size_t>(first.key_frame)].frame,
                            first.key_point, position);
  entry.first_key_frame = std::min(first.key_frame, second.key_frame);
  entry.last_key_frame = std::max(first.key_frame, second.key_frame);
  entry.observations = {first, second};
  const int point = points_.add(std::move(entry));
  seenBy(first) = point;
  seenBy(second) = point;
}

bool Map::mayBecomePoint(const Frame& frame, std::size_t key_point) const {
  const float depth = frame.points.depth[key_point];
  return frame.map_point[key_point] == kNoMapPoint && hasDepth(depth) &&
         depth <= options_.max_depth && mayEnterMap(frame, key_point);
}

std::size_t Map::newPointsIn(const Frame& frame) const {
  std::size_t count = 0;
  for (std::size_t i = 0; i < frame.points.size(); ++i) {
    count += mayBecomePoint(frame, i) ? 1 : 0;
  }
  return count;
}

void Map::addObservation(int point, int key_frame, std::size_t key_point) {
  MapPoint* entry = points_.find(point);
  int& there = key_frames_[static_cast<std::size_t>(key_frame)].frame.map_point[key_point];
  if (entry == nullptr || there != kNoMapPoint) {
    return;
  }
  const bool seen = std::any_of(entry->observations.begin(), entry->observations.end(),
                                [&](const Observation& o) { return o.key_frame == key_frame; });
  if (!seen) {
    there = point;
    entry->observations.push_back({key_frame, key_point});
    entry->last_key_frame = std::max(entry->last_key_frame, key_frame);
  }
}

void Map::observe(const Frame& frame, std::size_t key_point, int point) {
  MapPoint& entry = *points_.find(point);
  entry.descriptor = descriptorOf(frame, key_point);
  entry.octave = frame.features.key_points[key_point].octave;
  entry.distance = (frame.camera_from_world * entry.position).norm();
  entry.last_key_frame = static_cast<int>(key_frames_.size());
}

int Map::create(const Frame& frame, std::size_t key_point) {
  MapPoint entry = describe(frame, key_point, worldPoint(frame, key_point, camera_));
  entry.first_key_frame = static_cast<int>(key_frames_.size());
  entry.last_key_frame = entry.first_key_frame;
  return points_.add(std::move(entry));
}

void Map::insertKeyFrame(Frame frame) {
  const int number = static_cast<int>(key_frames_.size());
  KeyFrame key_frame;
  for (std::size_t i = 0; i < frame.points.size(); ++i) {
    int& point = frame.map_point[i];
    if (point != kNoMapPoint && points_[static_cast<std::size_t>(point)].removed) {
      point = kNoMapPoint;
    }
    if (point != kNoMapPoint) {
      observe(frame, i, point);
    } else if (mayBecomePoint(frame, i)) {
      point = create(frame, i);
    }
    if (point != kNoMapPoint) {
      points_.find(point)->observations.push_back({number, i});
      ++key_frame.map_points;
    }
  }
  // The prior tells of the way from the frame before, not from further back.
  const bool follows = !key_frames_.empty() && key_frames_.back().frame.index + 1 == frame.index;
  if (frame.prior && follows) {
    key_frame.motion =
        KeyFrameMotion{number - 1, frame.prior->camera_from_world * poseOf(number - 1).inverse(),
                       frame.prior->covariance.inverse()};
  }
  key_frame.frame = std::move(frame);
  key_frames_.push_back(std::move(key_frame));
}

std::vector<std::pair<int, int>> Map::sharedPoints(const std::vector<int>& map_points,
                                                   int except) const {
  std::map<int, int> shared;
  for (const int point : map_points) {
    if (point == kNoMapPoint) {
      continue;
    }
    for (const Observation& seen : points_[static_cast<std::size_t>(point)].observations) {
      ++shared[seen.key_frame];
    }
  }
  shared.erase(except);
  std::vector<std::pair<int, int>> most_first(shared.begin(), shared.end());
  std::stable_sort(most_first.begin(), most_first.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  return most_first;
}

std::vector<std::pair<int, int>> Map::covisible(int key_frame) const {
  return sharedPoints(key_frames_[static_cast<std::size_t>(key_frame)].frame.map_point, key_frame);
}

std::vector<int> Map::localKeyFrames(const Frame& frame) const {
  constexpr int kNone = -1;
  std::vector<int> local;
  const auto full = [&] {
    return local.size() >= static_cast<std::size_t>(options_.local_key_frames);
  };
  // The latest few first: what was just seen may not be matched yet.
  constexpr int kLatest = 4;
  for (int k = static_cast<int>(key_frames_.size()) - 1;
       k >= 0 && static_cast<int>(local.size()) < kLatest && !full(); --k) {
    if (!key_frames_[static_cast<std::size_t>(k)].removed) {
      local.push_back(k);
    }
  }
  for (const auto& [key_frame, shared] : sharedPoints(frame.map_point, kNone)) {
    if (full()) {
      break;
    }
    if (std::find(local.begin(), local.end(), key_frame) == local.end()) {
      local.push_back(key_frame);
    }
  }
  return local;
}

std::vector<int> Map::nearestKeyFrames(const Eigen::Isometry3d& camera_from_world) const {
  const Eigen::Vector3d centre = camera_from_world.inverse().translation();
  const Eigen::Vector3d axis = camera_from_world.linear().row(2);
  constexpr double kSameWay = 0.7;  // cosine
  std::vector<std::pair<double, int>> by_distance;
  for (std::size_t k = 0; k < key_frames_.size(); ++k) {
    const Eigen::Isometry3d& pose = key_frames_[k].frame.camera_from_world;
    if (!key_frames_[k].removed && axis.dot(pose.linear().row(2)) > kSameWay) {
      by_distance.emplace_back((pose.inverse().translation() - centre).norm(), static_cast<int>(k));
    }
  }
  std::sort(by_distance.begin(), by_distance.end());
  std::vector<int> nearest;
  for (const auto& [distance, key_frame] : by_distance) {
    if (nearest.size() >= static_cast<std::size_t>(options_.local_key_frames)) {
      break;
    }
    nearest.push_back(key_frame);
  }
  return nearest;
}

std::vector<int> Map::pointsOf(const std::vector<int>& key_frames) const {
  std::vector<int> local;
  for (const int key_frame : key_frames) {
    for (const int point : key_frames_[static_cast<std::size_t>(key_frame)].frame.map_point) {
      if (point != kNoMapPoint && !points_[static_cast<std::size_t>(point)].removed) {
        local.push_back(point);
      }
    }
  }
  std::sort(local.begin(), local.end());
  local.erase(std::unique(local.begin(), local.end()), local.end());
  return local;
}

void Map::removePoint(int point) {
  for (const Observation& seen : points_[static_cast<std::size_t>(point)].observations) {
    key_frames_[static_cast<std::size_t>(seen.key_frame)].frame.map_point[seen.key_point] =
        kNoMapPoint;
  }
  points_.remove(point);
}

void Map::cullPoints() {
  constexpr std::size_t kEnoughToJudge = 5;
  const auto useless = [this](const MapPoint& point) {
    const bool rarely_found = point.visible >= kEnoughToJudge &&
                              static_cast<double>(point.found) <
                                  options_.min_found_share * static_cast<double>(point.visible);
    return point.observations.empty() || rarely_found ||
           point.trust.log_odds < options_.trust.removal;
  };
  for (const int point : points_.where(useless)) {
    removePoint(point);
  }
}

void Map::removeKeyFrame(int key_frame) {
  KeyFrame& entry = key_frames_[static_cast<std::size_t>(key_frame)];
  const std::vector<std::pair<int, int>> neighbours = covisible(key_frame);
  if (neighbours.empty()) {
    return;
  }
  entry.anchor = neighbours.front().first;
  entry.from_anchor = entry.frame.camera_from_world * poseOf(entry.anchor).inverse();
  for (const int point : entry.frame.map_point) {
    if (point == kNoMapPoint) {
      continue;
    }
    std::vector<Observation>& seen = points_.find(point)->observations;
    seen.erase(std::remove_if(seen.begin(), seen.end(),
                              [&](const Observation& o) { return o.key_frame == key_frame; }),
               seen.end());
  }
  Frame bare;
  bare.index = entry.frame.index;
  bare.timestamp = entry.frame.timestamp;
  bare.camera_from_world = entry.frame.camera_from_world;
  entry.frame = std::move(bare);
  entry.motion.reset();
  entry.removed = true;
}

void Map::cullKeyFrames() {
  // Neither the first, which holds the world in its place, nor the latest, which are still at work.
  constexpr int kLatest = 3;
  for (int k = 1; k + kLatest < static_cast<int>(key_frames_.size()); ++k) {
    const KeyFrame& entry = key_frames_[static_cast<std::size_t>(k)];
    if (entry.removed) {
      continue;
    }
    std::size_t points = 0;
    std::size_t seen_by_others = 0;
    for (const int point : entry.frame.map_point) {
      if (point != kNoMapPoint) {
        ++points;
        seen_by_others += points_[static_cast<std::size_t>(point)].observations.size() >
                                  options_.superfluous_observers
                              ? 1
                              : 0;
      }
    }
    if (points > 0 && static_cast<double>(seen_by_others) >
                          options_.superfluous_share * static_cast<double>(points)) {
      removeKeyFrame(k);
    }
  }
}

void Map::cull() {
  cullPoints();
  cullKeyFrames();
}

int Map::survivorOf(int key_frame) const {
  while (key_frames_[static_cast<std::size_t>(key_frame)].removed) {
    key_frame = key_frames_[static_cast<std::size_t>(key_frame)].anchor;
  }
  return key_frame;
}

Eigen::Isometry3d Map::poseOf(int key_frame) const {
  Eigen::Isometry3d from_root = Eigen::Isometry3d::Identity();
  const KeyFrame* entry = &key_frames_[static_cast<std::size_t>(key_frame)];
  while (entry->removed) {
    from_root = from_root * entry->from_anchor;
    entry = &key_frames_[static_cast<std::size_t>(entry->anchor)];
  }
  return from_root * entry->frame.camera_from_world;
}

void Map::dropObservation(int point, int key_frame) {
  MapPoint* entry = points_.find(point);
  if (entry == nullptr) {
    return;
  }
  const auto seen =
      std::find_if(entry->observations.begin(), entry->observations.end(),
                   [key_frame](const Observation& o) { return o.key_frame == key_frame; });
  if (seen != entry->observations.end()) {
    key_frames_[static_cast<std::size_t>(key_frame)].frame.map_point[seen->key_point] = kNoMapPoint;
    entry->observations.erase(seen);
  }
}

void Map::fusePoints(int point, int into) {
  const MapPoint* gone = points_.find(point);
  MapPoint* kept = points_.find(into);
  if (gone == nullptr || kept == nullptr || point == into) {
    return;
  }
  for (const Observation& seen : gone->observations) {
    const bool both =
        std::any_of(kept->observations.begin(), kept->observations.end(),
                    [&](const Observation& other) { return other.key_frame == seen.key_frame; });
    key_frames_[static_cast<std::size_t>(seen.key_frame)].frame.map_point[seen.key_point] =
        both ? kNoMapPoint : into;
    if (!both) {
      kept->observations.push_back(seen);
    }
  }
  kept->last_key_frame = std::max(kept->last_key_frame, gone->last_key_frame);
  kept->visible += gone->visible;
  kept->found += gone->found;
  points_.remove(point);
}

void Map::apply(const MapCorrection& correction) {
  if (correction.key_frames.empty()) {
    return;
  }
  const auto latest =
      std::max_element(correction.key_frames.begin(), correction.key_frames.end(),
                       [](const auto& a, const auto& b) { return a.first < b.first; });
  // What came after the snapshot moves with the latest key frame in it.
  const Eigen::Isometry3d old_world_from_new = poseOf(latest->first).inverse() * latest->second;
  for (int k = latest->first + 1; k < static_cast<int>(key_frames_.size()); ++k) {
    Frame& frame = key_frames_[static_cast<std::size_t>(k)].frame;
    frame.camera_from_world = frame.camera_from_world * old_world_from_new;
  }
  points_.forEach([&](MapPoint& point) {
    if (point.first_key_frame > latest->first) {
      point.position = old_world_from_new.inverse() * point.position;
    }
  });
  for (const auto& [key_frame, pose] : correction.key_frames) {
    key_frames_[static_cast<std::size_t>(key_frame)].frame.camera_from_world = pose;
  }
  for (const auto& [point, position] : correction.points) {
    if (MapPoint* entry = points_.find(point)) {
      entry->position = position;
    }
  }
  for (const auto& [point, offset] : correction.depth_offsets) {
    if (MapPoint* entry = points_.find(point)) {
      entry->depth_offset = offset;
    }
  }
  for (const auto& [point, key_frame] : correction.outliers) {
    dropObservation(point, key_frame);
  }
  for (const auto& [point, into] : correction.fused) {
    fusePoints(point, into);
  }
}

}  // namespace hmcdyn::slam

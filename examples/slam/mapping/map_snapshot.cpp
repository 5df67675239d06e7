// SPDX-License-Identifier: BSD-3-Clause
#include "slam/mapping/map_snapshot.hpp"

#include <cstddef>

#include "slam/mapping/local_bundle.hpp"

namespace hmcdyn::slam {
namespace {

/// A person who stands still looks static, and is somewhere else the next time.
bool isBackground(const Frame& frame, std::size_t key_point) {
  return frame.map_point[key_point] != kNoMapPoint ||
         (frame.label[key_point] == PointLabel::kStatic && frame.in_person[key_point] == 0);
}

LoopSnapshot::Sighting sightingOf(const Frame& frame, const Observation& seen, int point) {
  LoopSnapshot::Sighting sighting;
  sighting.key_frame = static_cast<std::size_t>(seen.key_frame);
  sighting.point = point;
  sighting.u = frame.points.u[seen.key_point];
  sighting.v = frame.points.v[seen.key_point];
  sighting.sigma = frame.sigma[seen.key_point];
  sighting.depth = frame.points.depth[seen.key_point];
  sighting.weight = frame.weight[seen.key_point];
  return sighting;
}

/// What a small motion (rotation vector, translation) is on the other side of a rigid one.
Eigen::Matrix<double, 6, 6> adjointOf(const Eigen::Isometry3d& motion) {
  const Eigen::Vector3d& t = motion.translation();
  Eigen::Matrix3d cross;
  cross << 0.0, -t.z(), t.y(), t.z(), 0.0, -t.x(), -t.y(), t.x(), 0.0;
  Eigen::Matrix<double, 6, 6> adjoint = Eigen::Matrix<double, 6, 6>::Zero();
  adjoint.topLeftCorner<3, 3>() = motion.linear();
  adjoint.bottomRightCorner<3, 3>() = motion.linear();
  adjoint.bottomLeftCorner<3, 3>() = cross * motion.linear();
  return adjoint;
}

void addPoints(const Map& map, LoopSnapshot& snapshot) {
  for (std::size_t i = 0; i < map.points().size(); ++i) {
    const MapPoint& point = map.points()[i];
    if (point.removed || point.observations.empty()) {
      continue;
    }
    const int id = static_cast<int>(i);
    snapshot.points.push_back(
        {id, point.position, static_cast<std::size_t>(point.observations.front().key_frame)});
    if (point.belief.log_odds < map.options().belief.trust) {
      continue;
    }
    for (const Observation& seen : point.observations) {
      snapshot.sightings.push_back(
          sightingOf(map.keyFrames()[static_cast<std::size_t>(seen.key_frame)].frame, seen, id));
    }
  }
}

}  // namespace

LoopKeyFrame makeLoopKeyFrame(const Frame& frame) {
  LoopKeyFrame key_frame;
  key_frame.timestamp = frame.timestamp;
  key_frame.camera_from_world = frame.camera_from_world;
  std::vector<int> rows;
  for (std::size_t i = 0; i < frame.points.size(); ++i) {
    if (isBackground(frame, i)) {
      rows.push_back(static_cast<int>(i));
    }
  }
  key_frame.descriptors.create(static_cast<int>(rows.size()), 32, CV_8U);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const auto i = static_cast<std::size_t>(rows[k]);
    frame.features.descriptors.row(rows[k]).copyTo(key_frame.descriptors.row(static_cast<int>(k)));
    key_frame.points.push_back(frame.points.u[i], frame.points.v[i], frame.points.depth[i]);
    key_frame.sigma.push_back(frame.sigma[i]);
    key_frame.map_point.push_back(frame.map_point[i]);
  }
  return key_frame;
}

LoopKeyFrame makeLoopKeyFrame(const Map& map, int key_frame) {
  LoopKeyFrame copy = makeLoopKeyFrame(map.keyFrames()[static_cast<std::size_t>(key_frame)].frame);
  copy.id = static_cast<std::size_t>(key_frame);
  for (const auto& [other, shared] : map.covisible(key_frame)) {
    copy.covisible.emplace_back(static_cast<std::size_t>(other), shared);
  }
  return copy;
}

std::optional<LoopConstraint> survivingLoop(const Map& map, const LoopConstraint& loop) {
  const int from = map.survivorOf(static_cast<int>(loop.from));
  const int to = map.survivorOf(static_cast<int>(loop.to));
  if (from == to) {
    return std::nullopt;
  }
  const auto fromSurvivor = [&map](std::size_t culled, int survivor) {
    return map.poseOf(static_cast<int>(culled)) * map.poseOf(survivor).inverse();
  };
  LoopConstraint surviving = loop;
  surviving.from = static_cast<std::size_t>(from);
  surviving.to = static_cast<std::size_t>(to);
  const Eigen::Isometry3d to_from_survivor = fromSurvivor(loop.to, to);
  surviving.to_from = to_from_survivor.inverse() * loop.to_from * fromSurvivor(loop.from, from);
  const Eigen::Matrix<double, 6, 6> moved = adjointOf(to_from_survivor);
  surviving.information = moved.transpose() * loop.information * moved;
  if (from != static_cast<int>(loop.from) || to != static_cast<int>(loop.to)) {
    surviving.key_points.clear();  // they were the culled ones'
  }
  return surviving;
}

LoopSnapshot makeLoopSnapshot(const Map& map, const std::vector<LoopConstraint>& loops) {
  LoopSnapshot snapshot;
  snapshot.camera = map.camera();
  for (std::size_t k = 0; k < map.keyFrames().size(); ++k) {
    const int key_frame = static_cast<int>(k);
    if (map.keyFrames()[k].removed) {
      continue;
    }
    snapshot.key_frames.push_back({k, map.poseOf(key_frame)});
    for (const auto& [other, shared] : map.covisible(key_frame)) {
      if (other < key_frame) {
        snapshot.covisibility.push_back({static_cast<std::size_t>(other), k, shared});
      }
    }
  }
  snapshot.loops = loops;
  addPoints(map, snapshot);
  return snapshot;
}

MapCorrection toCorrection(const LoopSnapshot& snapshot, const LoopClosure& closure) {
  MapCorrection correction;
  for (const CorrectedPose& pose : closure.key_frames) {
    correction.key_frames.emplace_back(static_cast<int>(pose.id), pose.camera_from_world);
  }
  for (const CorrectedPoint& point : closure.points) {
    correction.points.emplace_back(point.id, point.position);
    if (point.fused_into != point.id) {
      correction.fused.emplace_back(point.id, point.fused_into);
    }
  }
  const bool judged = judgesObservations(closure.bundle);
  for (std::size_t k = 0; judged && k < closure.inlier.size(); ++k) {
    if (closure.inlier[k] == 0 && snapshot.sightings[k].weight > 0.0f) {
      correction.outliers.emplace_back(snapshot.sightings[k].point,
                                       static_cast<int>(snapshot.sightings[k].key_frame));
    }
  }
  return correction;
}

}  // namespace hmcdyn::slam

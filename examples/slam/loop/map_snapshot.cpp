// SPDX-License-Identifier: BSD-3-Clause
#include "slam/loop/map_snapshot.hpp"

#include <cstddef>
#include <numeric>
#include <utility>

#include "se3.hpp"
#include "slam/map/local_bundle.hpp"

namespace hmcdyn::slam {
namespace {

/// A person who stands still looks static, and is somewhere else the next time.
bool isBackground(const Frame& frame, std::size_t key_point) {
  return frame.map_point[key_point] != kNoMapPoint ||
         (frame.label[key_point] == PointLabel::kStatic && frame.in_person[key_point] == 0);
}

std::shared_ptr<const KeyFrameSightings> sightingsOf(const Frame& frame,
                                                     const DepthErrorModel& depth_error) {
  std::vector<std::size_t> all(frame.points.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  return std::make_shared<const KeyFrameSightings>(KeyFrameSightings{
      frame.points, frame.sigma, frame.weight, depthSigmas(frame, all, depth_error)});
}

/// Which key point of which key frame sees each map point, key frames in order.
class Observers {
 public:
  struct Observer {
    std::size_t key_frame = 0;  // place in the copy
    std::size_t key_point = 0;
  };

  explicit Observers(const MapCopy& copy) : first_(copy.point_position.size() + 1, 0) {
    forEach(copy, [this](std::size_t point, const Observer&) { ++first_[point + 1]; });
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    observers_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    forEach(copy, [&](std::size_t point, const Observer& observer) {
      observers_[next[point]++] = observer;
    });
  }

  Span<const Observer> of(std::size_t point) const {
    return {observers_.data() + first_[point], first_[point + 1] - first_[point]};
  }

 private:
  template <class Visit>
  static void forEach(const MapCopy& copy, const Visit& visit) {
    for (std::size_t k = 0; k < copy.key_frames.size(); ++k) {
      const std::vector<int>& points = copy.key_frames[k].map_point;
      for (std::size_t i = 0; i < points.size(); ++i) {
        if (points[i] != kNoMapPoint) {
          visit(static_cast<std::size_t>(points[i]), Observer{k, i});
        }
      }
    }
  }

  std::vector<std::size_t> first_;
  std::vector<Observer> observers_;
};

LoopSnapshot::Sighting sightingOf(const MapCopy& copy, const Observers::Observer& observer,
                                  std::size_t point) {
  const MapCopy::KeyFrameCopy& key_frame = copy.key_frames[observer.key_frame];
  LoopSnapshot::Sighting sighting;
  sighting.key_frame = key_frame.id;
  sighting.point = static_cast<int>(point);
  sighting.u = key_frame.seen->points.u[observer.key_point];
  sighting.v = key_frame.seen->points.v[observer.key_point];
  sighting.sigma = key_frame.seen->sigma[observer.key_point];
  sighting.depth = key_frame.seen->points.depth[observer.key_point];
  sighting.depth_sigma = key_frame.seen->depth_sigma[observer.key_point];
  sighting.weight = key_frame.seen->weight[observer.key_point];
  return sighting;
}

void addPoints(const MapCopy& copy, const Observers& observers, LoopSnapshot& snapshot) {
  for (std::size_t i = 0; i < copy.point_position.size(); ++i) {
    const auto seen_by = observers.of(i);
    if (seen_by.size() == 0) {
      continue;  // removed, or on its way there
    }
    snapshot.points.push_back({static_cast<int>(i), copy.point_position[i],
                               copy.key_frames[seen_by[0].key_frame].id,
                               copy.point_depth_offset[i]});
    if (copy.point_trusted[i] != 0) {
      for (const Observers::Observer& observer : seen_by) {
        snapshot.sightings.push_back(sightingOf(copy, observer, i));
      }
    }
  }
}

/// Pairs of key frames and how many points they share.
void addCovisibility(const MapCopy& copy, const Observers& observers, LoopSnapshot& snapshot) {
  for (std::size_t k = 0; k < copy.key_frames.size(); ++k) {
    std::vector<int> shared(k, 0);
    for (const int point : copy.key_frames[k].map_point) {
      if (point == kNoMapPoint) {
        continue;
      }
      for (const Observers::Observer& observer : observers.of(static_cast<std::size_t>(point))) {
        if (observer.key_frame < k) {
          ++shared[observer.key_frame];
        }
      }
    }
    for (std::size_t other = 0; other < k; ++other) {
      if (shared[other] > 0) {
        snapshot.covisibility.push_back(
            {copy.key_frames[other].id, copy.key_frames[k].id, shared[other]});
      }
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
  const Eigen::Matrix<double, 6, 6> moved = se3::adjoint(to_from_survivor);
  surviving.information = moved.transpose() * loop.information * moved;
  if (from != static_cast<int>(loop.from) || to != static_cast<int>(loop.to)) {
    surviving.key_points.clear();  // they were the culled ones'
  }
  return surviving;
}

void MapCopier::remember(const Map& map) {
  const std::size_t known = seen_.size();
  seen_.resize(map.keyFrames().size());
  for (std::size_t k = known; k < seen_.size(); ++k) {
    if (!map.keyFrames()[k].removed) {
      seen_[k] = sightingsOf(map.keyFrames()[k].frame, map.options().depth_error);
    }
  }
}

MapCopy MapCopier::copy(const Map& map, std::vector<LoopConstraint> loops) {
  remember(map);
  MapCopy copy;
  copy.camera = map.camera();
  copy.loops = std::move(loops);
  copy.key_frames.reserve(map.keyFrames().size());
  for (std::size_t k = 0; k < map.keyFrames().size(); ++k) {
    const KeyFrame& key_frame = map.keyFrames()[k];
    if (key_frame.removed) {
      seen_[k].reset();
    } else {
      copy.key_frames.push_back(
          {k, key_frame.frame.camera_from_world, seen_[k], key_frame.frame.map_point});
    }
  }
  copy.point_position.reserve(map.points().size());
  copy.point_depth_offset.reserve(map.points().size());
  copy.point_trusted.reserve(map.points().size());
  for (const MapPoint& point : map.points()) {
    copy.point_position.push_back(point.position);
    copy.point_depth_offset.push_back(point.depth_offset);
    copy.point_trusted.push_back(point.trust.log_odds >= map.options().trust.threshold ? 1 : 0);
  }
  return copy;
}

LoopSnapshot toSnapshot(const MapCopy& copy) {
  LoopSnapshot snapshot;
  snapshot.camera = copy.camera;
  snapshot.loops = copy.loops;
  for (const MapCopy::KeyFrameCopy& key_frame : copy.key_frames) {
    snapshot.key_frames.push_back({key_frame.id, key_frame.camera_from_world});
  }
  const Observers observers(copy);
  addPoints(copy, observers, snapshot);
  addCovisibility(copy, observers, snapshot);
  return snapshot;
}

MapCorrection toCorrection(const LoopSnapshot& snapshot, const LoopClosure& closure) {
  MapCorrection correction;
  for (const CorrectedPose& pose : closure.key_frames) {
    correction.key_frames.emplace_back(static_cast<int>(pose.id), pose.camera_from_world);
  }
  for (const CorrectedPoint& point : closure.points) {
    correction.points.emplace_back(point.id, point.position);
    correction.depth_offsets.emplace_back(point.id, point.depth_offset);
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

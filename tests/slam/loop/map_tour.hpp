// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "loop/tour.hpp"
#include "slam/features/frame.hpp"
#include "slam/map/map.hpp"

namespace hmcdyn::slam::test {

/// A frame of what is seen, in the tracker's terms; a key point's class_id is its landmark.
inline Frame frameOf(const LoopKeyFrame& seen) {
  Frame frame;
  frame.index = seen.id;
  frame.timestamp = seen.timestamp;
  frame.camera_from_world = seen.camera_from_world;
  frame.tracked = true;
  frame.features.descriptors = seen.descriptors;
  frame.points = seen.points;
  frame.sigma = seen.sigma;
  for (std::size_t i = 0; i < seen.points.size(); ++i) {
    frame.features.key_points.emplace_back(seen.points.u[i], seen.points.v[i], 31.0f);
    frame.features.key_points.back().class_id = seen.map_point[i];
  }
  frame.label.assign(seen.points.size(), PointLabel::kStatic);
  frame.lambda.assign(seen.points.size(), 1.0f);
  frame.weight.assign(seen.points.size(), 1.0f);
  frame.depth_spread.assign(seen.points.size(), 0.0f);
  frame.in_person.assign(seen.points.size(), 0);
  frame.map_point.assign(seen.points.size(), kNoMapPoint);
  return frame;
}

/// A map that grows by a key frame a step, as a tracker with drift makes it: a landmark keeps its
/// map point while it is in view, and has a new one when it comes back.
class MapTour {
 public:
  MapTour(Landmarks landmarks, Drift drift)
      : map(kLens, {}), landmarks_(std::move(landmarks)), drift_(std::move(drift)) {}

  Map map;
  std::vector<Eigen::Isometry3d> truth;

  /// What is seen from the k-th place of the tour.
  Frame seenFrom(std::size_t k) const {
    return frameOf(see(landmarks_, k, onTour(k), static_cast<std::uint32_t>(k) + 1, {0.3, 0.3, 6}));
  }

  void step() {
    const std::size_t k = truth.size();
    truth.push_back(onTour(k));
    Frame frame = seenFrom(k);
    if (k > 0) {
      frame.camera_from_world = motionOf(drift_.turn, drift_.shift) * truth[k] *
                                truth[k - 1].inverse() * map.poseOf(static_cast<int>(k) - 1);
      const Frame& before = map.keyFrames().back().frame;
      std::map<int, int> point_of;
      for (std::size_t i = 0; i < before.points.size(); ++i) {
        point_of[before.features.key_points[i].class_id] = before.map_point[i];
      }
      for (std::size_t i = 0; i < frame.points.size(); ++i) {
        const auto found = point_of.find(frame.features.key_points[i].class_id);
        frame.map_point[i] = found == point_of.end() ? kNoMapPoint : found->second;
      }
    }
    map.insertKeyFrame(std::move(frame));
    for (const int point : map.keyFrames().back().frame.map_point) {
      if (point != kNoMapPoint) {
        map.count(point, true, {});
        map.count(point, true, {});  // trusted
      }
    }
  }

  double worstPose() const {
    double worst = 0.0;
    for (std::size_t k = 0; k < truth.size(); ++k) {
      worst = std::max(worst, metresBetween(map.poseOf(static_cast<int>(k)), truth[k]));
    }
    return worst;
  }

 private:
  Landmarks landmarks_;
  Drift drift_;
};

}  // namespace hmcdyn::slam::test

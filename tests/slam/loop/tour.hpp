// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "loop/place_scene.hpp"
#include "slam/loop/loop_closer.hpp"

namespace hmcdyn::slam::test {

/// What the odometry of a tour does wrong at each step.
struct Drift {
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();   ///< rad
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  ///< m
};

/// A round through a round hall, the camera looking outwards, and back over the first key frames: a
/// map as a tracker with drift makes it. A landmark that comes into view again is a new map point,
/// placed by the key frame that sees it first.
struct Tour {
  static constexpr std::size_t kRound = 48;  ///< Key frames a round.

  std::vector<Eigen::Isometry3d> truth;
  std::vector<Eigen::Vector3d> true_point;  ///< By map point.
  LoopSnapshot snapshot;                    ///< With drift, without a loop.
  std::map<int, std::vector<int>> points_of_landmark;

  std::size_t last() const { return truth.size() - 1; }
};

inline Landmarks hall(std::uint32_t seed, int n) {
  Random random(seed);
  Landmarks landmarks;
  for (int i = 0; i < n; ++i) {
    const double angle = random.uniform(0.0, 2.0 * std::acos(-1.0));
    const double radius = random.uniform(3.5, 5.0);
    const double y = random.uniform(-1.2, 1.2);
    landmarks.push_back(
        {{radius * std::sin(angle), y, radius * std::cos(angle)}, randomDescriptor(random)});
  }
  return landmarks;
}

/// The k-th true pose: on a circle of 1.5 m, looking outwards.
inline Eigen::Isometry3d onTour(std::size_t k) {
  const double angle = 2.0 * std::acos(-1.0) * static_cast<double>(k) / Tour::kRound;
  return motionOf(Eigen::Vector3d::Zero(), {0.0, 0.0, -1.5}) *
         motionOf({0.0, -angle, 0.0}, Eigen::Vector3d::Zero());
}

/// @param overlap key frames after the round is full.
/// @param depth_scale what the sensor makes of a metre.
inline Tour makeTour(const Drift& drift, const SightNoise& noise = {}, double depth_scale = 1.0,
                     std::size_t overlap = 3, int landmarks = 1500) {
  Tour tour;
  const Landmarks all = hall(77, landmarks);
  LoopSnapshot& map = tour.snapshot;
  map.camera = kLens;
  std::map<int, std::size_t> seen_last;
  std::map<std::size_t, std::map<std::size_t, int>> shared;
  std::map<int, std::vector<std::size_t>> seen_by;
  for (std::size_t k = 0; k < Tour::kRound + overlap; ++k) {
    tour.truth.push_back(onTour(k));
    Eigen::Isometry3d estimate = tour.truth[0];
    if (k > 0) {
      const Eigen::Isometry3d step = tour.truth[k] * tour.truth[k - 1].inverse();
      estimate = motionOf(drift.turn, drift.shift) * step * map.key_frames[k - 1].camera_from_world;
    }
    map.key_frames.push_back({k, estimate});
    LoopKeyFrame frame = see(all, k, tour.truth[k], static_cast<std::uint32_t>(k) + 1, noise);
    for (float& depth : frame.points.depth) {
      depth *= static_cast<float>(depth_scale);
    }
    for (std::size_t i = 0; i < frame.points.size(); ++i) {
      const int landmark = frame.map_point[i];
      const auto last = seen_last.find(landmark);
      std::vector<int>& numbers = tour.points_of_landmark[landmark];
      if (last == seen_last.end() || last->second + 1 < k) {
        numbers.push_back(static_cast<int>(map.points.size()));
        const Eigen::Vector3d seen =
            kLens.unproject(frame.points.u[i], frame.points.v[i], frame.points.depth[i]);
        map.points.push_back({numbers.back(), estimate.inverse() * seen, k});
        tour.true_point.push_back(all[static_cast<std::size_t>(landmark)].position);
      }
      seen_last[landmark] = k;
      map.sightings.push_back({k, numbers.back(), frame.points.u[i], frame.points.v[i], 1.0f,
                               frame.points.depth[i], 1.0f});
      for (const std::size_t other : seen_by[numbers.back()]) {
        ++shared[other][k];
      }
      seen_by[numbers.back()].push_back(k);
    }
  }
  for (const auto& [a, others] : shared) {
    for (const auto& [b, weight] : others) {
      map.covisibility.push_back({a, b, weight});
    }
  }
  return tour;
}

/// What a loop detector finds between two key frames that see the same: their true relative pose,
/// and the points that are one.
inline LoopConstraint trueLoop(const Tour& tour, std::size_t from, std::size_t to) {
  LoopConstraint loop;
  loop.from = from;
  loop.to = to;
  loop.to_from = tour.truth[to] * tour.truth[from].inverse();
  loop.information = Eigen::Matrix<double, 6, 6>::Identity() * 1e8;
  std::map<int, int> of_from;
  for (const auto& sighting : tour.snapshot.sightings) {
    if (sighting.key_frame == from) {
      of_from[sighting.point] = 0;
    }
  }
  for (const auto& [landmark, numbers] : tour.points_of_landmark) {
    for (const int a : numbers) {
      for (const auto& sighting : tour.snapshot.sightings) {
        if (sighting.key_frame == to && of_from.count(a) != 0 && sighting.point != a &&
            std::find(numbers.begin(), numbers.end(), sighting.point) != numbers.end()) {
          loop.map_points.emplace_back(a, sighting.point);
        }
      }
    }
  }
  loop.inliers = loop.map_points.size();
  return loop;
}

inline double largestError(const std::vector<CorrectedPose>& poses, const Tour& tour) {
  double largest = 0.0;
  for (const CorrectedPose& pose : poses) {
    largest = std::max(largest, metresBetween(pose.camera_from_world, tour.truth[pose.id]));
  }
  return largest;
}

}  // namespace hmcdyn::slam::test

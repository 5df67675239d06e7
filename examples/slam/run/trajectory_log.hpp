// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Geometry>

#include "slam/map/map.hpp"
#include "slam/output/tum_line.hpp"

namespace hmcdyn::slam {

/// Where each frame was, told from a key frame, so that what moves the key frame later (bundle
/// adjustment, a closed loop) moves the frame as well.
class TrajectoryLog {
 public:
  void add(double timestamp, const Eigen::Isometry3d& camera_from_world, int key_frame,
           const Map& map) {
    entries_.push_back({timestamp, key_frame, camera_from_world * map.poseOf(key_frame).inverse()});
  }

  /// The poses as the map has them now.
  std::vector<StampedPose> poses(const Map& map) const {
    std::vector<StampedPose> all;
    all.reserve(entries_.size());
    for (const Entry& entry : entries_) {
      all.push_back({entry.timestamp, entry.from_key_frame * map.poseOf(entry.key_frame)});
    }
    return all;
  }

 private:
  struct Entry {
    double timestamp;
    int key_frame;
    Eigen::Isometry3d from_key_frame;
  };
  std::vector<Entry> entries_;
};

}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "slam/loop/loop_closer.hpp"
#include "slam/loop/loop_key_frame.hpp"
#include "slam/map/map.hpp"

namespace hmcdyn::slam {

// Copies of parts of the map for the loop thread, and the way back.

/// The key points of a frame that are believed static: those with a trusted map point, and those
/// outside people that the filter calls static. Without a number or covisibility.
LoopKeyFrame makeLoopKeyFrame(const Frame& frame);

/// A key frame of the map, with what it shares with others.
LoopKeyFrame makeLoopKeyFrame(const Map& map, int key_frame);

/// A loop whose ends may have been culled since, told between the key frames that they hang on.
/// None where both hang on one.
std::optional<LoopConstraint> survivingLoop(const Map& map, const LoopConstraint& loop);

/// What a key frame saw, N key points. It does not change while the key frame stands.
struct KeyFrameSightings {
  KeyPoints points;
  std::vector<float> sigma;        ///< px
  std::vector<float> weight;       ///< Of eq. 7.
  std::vector<float> depth_sigma;  ///< Of the depths (m).
};

/// The parts of a map that loop closing needs, as the map has them.
struct MapCopy {
  struct KeyFrameCopy {
    std::size_t id = 0;
    Eigen::Isometry3d camera_from_world = Eigen::Isometry3d::Identity();
    std::shared_ptr<const KeyFrameSightings> seen;  ///< Shared with other copies.
    std::vector<int> map_point;                     ///< N map points, or kNoMapPoint.
  };

  PinholeCamera camera;
  std::vector<KeyFrameCopy> key_frames;         ///< Those that stand, in order.
  std::vector<Eigen::Vector3d> point_position;  ///< World (m), by number.
  std::vector<double> point_depth_offset;       ///< Of its depths (1/m), by number.
  std::vector<std::uint8_t> point_trusted;      ///< 1 = believed to stand still, by number.
  std::vector<LoopConstraint> loops;
};

/// Copies a map that goes on growing. What does not change is copied once, when the key frame is
/// new, so that the tracking thread is not held up by a large map.
class MapCopier {
 public:
  /// Call it for each key frame, soon after it came; others are made up for in copy().
  void remember(const Map& map);

  /// @param loops between key frames that were not culled, see survivingLoop().
  MapCopy copy(const Map& map, std::vector<LoopConstraint> loops);

 private:
  std::vector<std::shared_ptr<const KeyFrameSightings>> seen_;  ///< By key frame.
};

/// The map as loop closing needs it: all key frames and points; sightings of trusted points only.
/// This takes its time, and needs no map: for another thread.
LoopSnapshot toSnapshot(const MapCopy& copy);

/// What a closed loop means for the map.
MapCorrection toCorrection(const LoopSnapshot& snapshot, const LoopClosure& closure);

}  // namespace hmcdyn::slam

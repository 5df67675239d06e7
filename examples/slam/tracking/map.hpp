// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include <hmcdyn/types.hpp>

#include "slam/tracking/frame.hpp"

namespace hmcdyn::slam {

/// An ORB descriptor.
using Descriptor = std::array<std::uint8_t, 32>;

/// A point of the world, as far as it is believed to stand still.
struct MapPoint {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< World (m).
  double information = 0.0;  ///< Of its depth measurements so far (1/m^2).
  Descriptor descriptor{};   ///< Of its latest key frame.
  int octave = 0;            ///< Pyramid level at which that key frame saw it ...
  double distance = 0.0;     ///< ... from this distance (m).
  int first_key_frame = 0;
  int last_key_frame = 0;        ///< Latest key frame that saw it.
  std::size_t visible = 0;       ///< Frames in which it should have been seen.
  std::size_t found = 0;         ///< Frames in which it was matched and agreed.
  std::size_t seen_dynamic = 0;  ///< Frames in which the filter called its key point dynamic.
  bool removed = false;
};

/// A frame that the map remembers.
struct KeyFrame {
  Frame frame;
  std::size_t map_points = 0;  ///< Key points with a map point.
};

struct MapOptions {
  /// Points farther than this (m) are not taken into the map: their depth is too uncertain.
  double max_depth = 10.0;
  int local_key_frames = 12;  ///< How many of the latest key frames make up the local map.
  /// A map point is removed when it was found in fewer than this share of the frames that should
  /// have seen it ...
  double min_found_share = 0.25;
  /// ... or when this share of its sightings was called dynamic.
  double max_dynamic_share = 0.3;
  /// Depth noise of the sensor, sigma = floor + quadratic z^2 (m); Khoshelham, Elberink 2012.
  double depth_noise_floor = 0.001;
  double depth_noise_quadratic = 1.425e-3;
};

/// The sparse map: key frames and the points that they see.
class Map {
 public:
  Map(PinholeCamera camera, MapOptions options) : camera_(camera), options_(options) {}

  const std::vector<MapPoint>& points() const noexcept { return points_; }
  const std::vector<KeyFrame>& keyFrames() const noexcept { return key_frames_; }

  /// Counts for a point: it should have been seen; it was found; it was called dynamic.
  void count(int point, bool found, bool dynamic);

  /// Makes a key frame: matched points take up its measurement, and static key points with depth
  /// become new points. A key point in a person's box becomes one only where the filter placed it
  /// clear of the person (weight above 0.5 in a dynamic box).
  void insertKeyFrame(Frame frame);

  /// Points of the latest key frames that were not removed, in the order of their numbers.
  std::vector<int> localPoints() const;

  /// Removes points that are rarely found, or called dynamic too often.
  void cull();

 private:
  void fuse(const Frame& frame, std::size_t key_point, int point);
  int create(const Frame& frame, std::size_t key_point);
  double depthInformation(double depth) const;

  PinholeCamera camera_;
  MapOptions options_;
  std::vector<MapPoint> points_;
  std::vector<KeyFrame> key_frames_;
};

}  // namespace hmcdyn::slam

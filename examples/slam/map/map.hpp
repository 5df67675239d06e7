// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <hmcdyn/depth_error.hpp>
#include <hmcdyn/types.hpp>

#include "slam/features/frame.hpp"
#include "slam/map/landmark_trust.hpp"
#include "slam/map/map_point.hpp"
#include "slam/map/point_table.hpp"

namespace hmcdyn::slam {

/// What the motion before a key frame says of where it stands to the one before it.
struct KeyFrameMotion {
  int from = 0;                                               ///< The key frame before.
  Eigen::Isometry3d to_from = Eigen::Isometry3d::Identity();  ///< Its frame to this one's.
  Eigen::Matrix<double, 6, 6> information;  ///< Inverse covariance, as PosePrior has it.
};

/// A frame that the map remembers. Its number is its place in Map::keyFrames().
struct KeyFrame {
  Frame frame;                 ///< Without features once it is removed.
  std::size_t map_points = 0;  ///< Key points that had a map point when it was inserted.
  std::optional<KeyFrameMotion> motion;
  bool removed = false;  ///< Superfluous: others see what it saw.
  int anchor = -1;       ///< Of a removed one: the key frame that it now hangs on ...
  Eigen::Isometry3d from_anchor = Eigen::Isometry3d::Identity();  ///< ... and by what.
};

struct MapOptions {
  /// Points farther than this (m) are not taken into the map: their depth is too uncertain.
  double max_depth = 10.0;
  int local_key_frames = 12;  ///< How many key frames make up the local map.
  /// A map point is removed when it was found in fewer than this share of the frames that should
  /// have seen it.
  double min_found_share = 0.25;
  LandmarkTrustOptions trust;
  /// A key frame is superfluous when this share of its points has more observers than this. What it
  /// saw is lost to later adjustments, so that three (as in ORB-SLAM) cost accuracy.
  double superfluous_share = 0.9;
  std::size_t superfluous_observers = 5;
  DepthErrorModel depth_error;  ///< Of the camera.
};

/// New places for key frames and points, from an optimisation over a snapshot of the map.
struct MapCorrection {
  std::vector<std::pair<int, Eigen::Isometry3d>> key_frames;  ///< camera_from_world, by number.
  std::vector<std::pair<int, Eigen::Vector3d>> points;        ///< World (m), by number.
  std::vector<std::pair<int, double>> depth_offsets;          ///< (1/m), by number.
  std::vector<std::pair<int, int>> outliers;  ///< Observations to drop: point, key frame.
  std::vector<std::pair<int, int>> fused;     ///< Points that are one: this one, and what stays.
};

/// Whether a key point stands still beyond doubt, so that the map may have it: outside people, or
/// clear of the moving person in depth.
bool mayEnterMap(const Frame& frame, std::size_t key_point);

/// The sparse map: key frames and the points that they see.
class Map {
 public:
  Map(PinholeCamera camera, MapOptions options) : camera_(camera), options_(options) {}

  const PinholeCamera& camera() const noexcept { return camera_; }
  const MapOptions& options() const noexcept { return options_; }
  const PointTable& points() const noexcept { return points_; }
  const std::vector<KeyFrame>& keyFrames() const noexcept { return key_frames_; }

  /// A frame should have seen the point: whether it was found, and what the filter said of it.
  void count(int point, bool found, const LandmarkSighting& evidence);

  /// Makes a key frame: matched points take up its observation, and static key points with depth
  /// become new points. A key point in a person's box becomes one only where the filter placed it
  /// clear of the person (lambda above 0.8 in a dynamic box).
  void insertKeyFrame(Frame frame);

  /// Key frames that share points with a frame, most first, and the latest ones after them: at most
  /// local_key_frames.
  std::vector<int> localKeyFrames(const Frame& frame) const;

  /// Key frames whose camera stood nearest to a pose and looked the same way (within 45 degrees),
  /// nearest first: at most local_key_frames.
  std::vector<int> nearestKeyFrames(const Eigen::Isometry3d& camera_from_world) const;

  /// Points that these key frames see and that were not removed, in the order of their numbers.
  std::vector<int> pointsOf(const std::vector<int>& key_frames) const;

  /// Key frames that share points with this one, and how many, most first.
  std::vector<std::pair<int, int>> covisible(int key_frame) const;

  /// Key points of a frame that would become new points.
  std::size_t newPointsIn(const Frame& frame) const;

  /// A new point that two key frames see with key points that had none; nothing where one has.
  void addPoint(const Eigen::Vector3d& position, const Observation& first,
                const Observation& second);

  /// A key frame sees a point with a key point that has none so far, else nothing happens.
  void addObservation(int point, int key_frame, std::size_t key_point);

  /// Makes one of two points: the key frames that saw `point` see `into`.
  void fusePoints(int point, int into);

  /// Removes points that are rarely found, or no longer believed to stand still, and key frames
  /// whose points enough others see.
  void cull();

  /// Takes up an optimisation's result. A key frame that is newer than the snapshot moves with the
  /// latest one in it, and its points with it.
  void apply(const MapCorrection& correction);

  /// The key frame itself, or of a removed one that which it hangs on.
  int survivorOf(int key_frame) const;

  /// The pose of a key frame, of a removed one by what it hangs on.
  Eigen::Isometry3d poseOf(int key_frame) const;

 private:
  bool mayBecomePoint(const Frame& frame, std::size_t key_point) const;
  MapPoint describe(const Frame& frame, std::size_t key_point,
                    const Eigen::Vector3d& position) const;
  void observe(const Frame& frame, std::size_t key_point, int point);
  int create(const Frame& frame, std::size_t key_point);
  void cullPoints();
  void cullKeyFrames();
  void removePoint(int point);
  void dropObservation(int point, int key_frame);
  void removeKeyFrame(int key_frame);
  std::vector<std::pair<int, int>> sharedPoints(const std::vector<int>& map_points,
                                                int except) const;

  PinholeCamera camera_;
  MapOptions options_;
  PointTable points_;
  std::vector<KeyFrame> key_frames_;
};

}  // namespace hmcdyn::slam

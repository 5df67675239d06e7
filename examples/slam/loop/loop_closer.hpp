// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <hmcdyn/types.hpp>

#include "slam/loop/loop_detector.hpp"
#include "slam/loop/pose_graph.hpp"
#include "slam/map/bundle_adjustment.hpp"

namespace hmcdyn::slam {

/// A copy of the map for its correction. Numbers of key frames and points are those of the live
/// map; the snapshot may leave some out.
struct LoopSnapshot {
  struct KeyFramePose {
    std::size_t id = 0;
    Eigen::Isometry3d camera_from_world = Eigen::Isometry3d::Identity();
  };
  struct Covisibility {
    std::size_t a = 0;  ///< Id of a key frame.
    std::size_t b = 0;  ///< Id of another.
    int weight = 0;     ///< Points that both see.
  };
  struct Point {
    int id = 0;
    Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< World (m).
    std::size_t anchor =
        0;  ///< Id of the key frame that it moves with, e.g. the first that saw it.
    double depth_offset = 0.0;  ///< Of its depths (1/m), see BundleProblem.
  };
  /// As BundleObservation, with ids for indices.
  struct Sighting {
    std::size_t key_frame = 0;
    int point = 0;
    float u = 0.0f, v = 0.0f;  ///< px
    float sigma = 1.0f;        ///< px
    float depth = 0.0f;        ///< m, 0 = none
    float weight = 1.0f;
    float depth_sigma = 0.0f;  ///< m, see BundleObservation
  };

  PinholeCamera camera;
  std::vector<KeyFramePose> key_frames;  ///< In order of time; the first one stays.
  std::vector<Covisibility> covisibility;
  std::vector<LoopConstraint> loops;  ///< All so far, the new one included.
  std::vector<Point> points;
  std::vector<Sighting> sightings;
};

struct LoopCloserOptions {
  int min_covisibility = 30;  ///< Points that two key frames share to be tied to each other; key
                              ///< frames that follow each other always are.
  /// Trust in the relative pose of two key frames that share `reference_covisibility` points; the
  /// information grows with their number.
  double covisibility_sigma_rotation = 0.005;    ///< rad
  double covisibility_sigma_translation = 0.01;  ///< m
  int reference_covisibility = 100;
  /// A loop is not believed to be better than this: its own covariance knows of noise in the
  /// pixels only, and Huber's loss bounds a false loop's pull the better the less it claims.
  double loop_sigma_rotation = 0.005;    ///< rad
  double loop_sigma_translation = 0.01;  ///< m
  PoseGraphOptions pose_graph;
  bool bundle_adjustment = true;  ///< Global, after the pose graph.
  BundleOptions bundle;
  /// A loop that the corrected map contradicts by more than this is refused: squared error of its
  /// relative pose (sigma^2), 99.9 % of chi2(6).
  double max_loop_error = 22.458;
};

/// A key frame's corrected pose.
using CorrectedPose = LoopSnapshot::KeyFramePose;

/// A point's corrected place.
struct CorrectedPoint {
  int id = 0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< World (m).
  int fused_into = 0;  ///< Id of the point that it is one with; its own where it is not fused.
  double depth_offset = 0.0;  ///< Of its depths (1/m).
};

struct LoopClosure {
  std::vector<CorrectedPose> key_frames;  ///< In the snapshot's order.
  std::vector<CorrectedPoint> points;     ///< In the snapshot's order.
  std::size_t fused = 0;                  ///< Points that are one with another now.
  /// Per sighting: 1 = agrees with the bundle adjustment. Empty without one.
  std::vector<std::uint8_t> inlier;
  double largest_correction = 0.0;  ///< Of a key frame's centre (m).
  std::vector<double> loop_error;   ///< Per loop, at `key_frames` (sigma^2).
  /// Place in the snapshot's loops of the one that is refused, the worst.
  std::optional<std::size_t> refused;
  /// False where a loop is refused, or the adjustment that would tell was stopped: key frames and
  /// points are as given then, and nothing is fused.
  bool closed = true;
  PoseGraphSolution pose_graph;  ///< Squared errors: loops first, in their order.
  BundleSolution bundle;
};

/// Corrects a map after a loop: optimises the pose graph of covisibility and loops, carries each
/// point along with its anchor key frame, makes one of the points that the loops call one, then
/// adjusts everything (global bundle adjustment), in which the fused points hold the loop shut.
///
/// A false loop asks for more bending than the observations along the way allow, and is open again
/// after the adjustment. So a loop that the result does not reproduce is refused.
///
/// The live map may have grown meanwhile. Then what is not in the snapshot moves with its
/// neighbour: T_new = T_old T_neighbour,old^-1 T_neighbour,corrected.
///
/// @throws std::invalid_argument for an id that appears twice or is unknown, and what
///   optimizePoseGraph() and adjustBundle() refuse.
LoopClosure closeLoops(const LoopSnapshot& snapshot, const LoopCloserOptions& options = {});

}  // namespace hmcdyn::slam

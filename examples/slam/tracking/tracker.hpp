// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include <hmcdyn/pose_refinement.hpp>
#include <hmcdyn/types.hpp>

#include "slam/mapping/map.hpp"
#include "slam/tracking/frame.hpp"
#include "slam/tracking/matcher.hpp"
#include "slam/tracking/motion_model.hpp"

namespace hmcdyn::slam {

struct KeyFramePolicy {
  /// A new key frame is due when fewer than this share of the reference key frame's points ...
  double min_reference_share = 0.8;
  std::size_t min_inliers = 150;  ///< ... or fewer than so many points are tracked, ...
  std::size_t max_interval = 10;  ///< ... or so many frames have passed since the last.
};

/// Refinement with a row for depth, which a depth camera measures independently of the pixels.
inline PoseRefinementOptions rgbdRefinement() {
  PoseRefinementOptions options;
  options.depth_row = DepthRow::kDepth;
  return options;
}

struct TrackerOptions {
  MapOptions map;
  MatcherOptions matcher;
  PoseRefinementOptions refinement = rgbdRefinement();
  MotionModelOptions motion;
  bool fuse_motion = true;  ///< Off: the motion only says where to search.
  KeyFramePolicy key_frames;
  float prediction_radius = 15.0f;  ///< Search window around the predicted pose (px).
  float wide_radius = 40.0f;        ///< The same after a first failure (px).
  float refined_radius = 5.0f;      ///< The same around the refined pose (px).
  std::size_t min_inliers = 20;     ///< Fewer, and the frame is lost.
  /// A key frame looks for points at its place that none of so many key frames before it saw: the
  /// local map has lost them, and they would be made again at each visit, without end.
  int forgotten_after = 20;
  /// How fast a camera moves (m/s, rad/s). A lost frame that is found where the camera can have got
  /// to is believed: within a second of the last tracked frame, else after the frame found before.
  double fastest = 2.0;
  double fastest_turn = 3.0;
  std::uint32_t seed = 1;  ///< Of the random draws in relocalisation.
};

/// Why a frame has no pose.
enum class TrackingFailure : std::uint8_t {
  kNone,             ///< It has one.
  kTooFewKeyPoints,  ///< Not enough static key points with depth to start a map.
  kTooFewMatches,    ///< Neither prediction nor relocalisation found enough map points.
  kUnconfirmed,      ///< Relocalised, far from the last known place: the next frame has to agree.
};

/// "none", "too few key points", "too few matches" or "not confirmed".
const char* toString(TrackingFailure failure) noexcept;

struct TrackingResult {
  TrackingFailure failure = TrackingFailure::kNone;
  bool new_key_frame = false;
  bool relocalized = false;  ///< The frame was found again after others were lost.
  int reference = 0;         ///< Key frame that the pose hangs on: what moves it, moves the pose.
  std::size_t matches = 0;   ///< Map points matched in the last search.
  std::size_t inliers = 0;   ///< Those that agree with the pose.
  Eigen::Isometry3d camera_from_world = Eigen::Isometry3d::Identity();
};

/// Camera tracking against a small local map: prediction by the motion model, projection matching,
/// weighted refinement (eq. 9-10), fusion with the motion model, key frames. The first frame's
/// camera is the world's origin. A frame that is found again far from where the last one was
/// changes nothing until the next one is found beside it.
class Tracker {
 public:
  Tracker(const PinholeCamera& camera, const TrackerOptions& options);

  /// Where a lost frame may be, by place recognition.
  using Relocalize = std::function<std::optional<Eigen::Isometry3d>(const Frame&)>;

  /// Tracks the next frame, whose points are labelled and weighted already.
  /// @param by_place is asked when neither prediction nor the latest key frames help; may be empty.
  TrackingResult track(Frame frame, const Relocalize& by_place = {});

  const Map& map() const noexcept { return map_; }

  /// Takes up an optimisation's result: the map moves, and the last frame with it.
  void apply(const MapCorrection& correction);

 private:
  struct Estimate {
    PoseRefinementResult refinement;
    ProjectionSearch search;
  };

  Estimate estimate(const Frame& frame, const KeyPointGrid& grid,
                    const std::vector<int>& candidates, const Eigen::Isometry3d& around,
                    float radius) const;
  PoseRefinementResult refine(const Frame& frame, const std::vector<PointMatch>& matches,
                              const Eigen::Isometry3d& initial) const;
  std::optional<Eigen::Isometry3d> relocalize(const Frame& frame) const;
  Estimate findAgain(const Frame& frame, const KeyPointGrid& grid,
                     const std::vector<int>& candidates, const Relocalize& by_place) const;
  bool needsKeyFrame(const Frame& frame) const;
  TrackingResult initialize(Frame frame);
  TrackingResult lose(TrackingFailure failure);
  bool isBelievable(double timestamp, const Eigen::Isometry3d& found) const;
  bool isReachable(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to,
                   double seconds) const;
  bool liesOn(const Frame& frame, const PointMatch& match) const;
  void tieToForgottenPoints(Frame& frame, const KeyPointGrid& grid) const;
  void countSightings(const Frame& frame, const ProjectionSearch& search);

  PinholeCamera camera_;
  TrackerOptions options_;
  Map map_;
  std::optional<Frame> last_;  ///< The last tracked frame.
  MotionModel motion_;
  bool lost_ = false;
  std::optional<std::pair<double, Eigen::Isometry3d>> unconfirmed_;  ///< Time (s) and pose.
  mutable PoseRefinementWorkspace workspace_;  ///< Memory only: changes no result.
};

}  // namespace hmcdyn::slam

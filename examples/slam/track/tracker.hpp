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

#include "slam/features/frame.hpp"
#include "slam/map/map.hpp"
#include "slam/map/triangulation.hpp"
#include "slam/track/duplicates.hpp"
#include "slam/track/matcher.hpp"
#include "slam/track/motion_model.hpp"

namespace hmcdyn::slam {

/// When a new key frame is due: when the camera sees what the map does not have. A camera that
/// stands still needs none.
struct KeyFramePolicy {
  /// Fewer points are tracked than this share of those that the last key frame tracked. Points that
  /// it made itself do not count: half of them are never seen again.
  double min_reference_share = 0.9;
  /// So few points are tracked, and so many others could be new ones.
  std::size_t min_inliers = 100;
  std::size_t min_new_points = 70;
  /// The camera has turned by so much since the last key frame (rad), or moved by this share of the
  /// depth of what it sees (median).
  double max_turn = 0.25;
  double max_parallax = 0.04;
};

/// Refinement with a row for depth, which a depth camera measures independently of the pixels.
inline PoseRefinementOptions rgbdRefinement() {  // depths by their own sigma
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
  /// Fewer, and the map has the word: points that it trusts are matched with whatever looks like
  /// them, whether or not the filter keeps it (MatchPolicy). ORB-SLAM's weak tracking, too, begins
  /// around a hundred.
  std::size_t few_inliers = 100;
  /// Where the map is not found at all, the filter's odometry carries the camera on for so long
  /// (s), as people who fill the image for a moment are gone before it has drifted by much.
  double longest_carry = 1.0;
  TriangulationOptions triangulation;  ///< Of key points without a depth.
  DuplicateOptions duplicates;         ///< Points that a key frame sees again.
  /// How fast a camera moves (m/s, rad/s). A lost frame that is found where the camera can have got
  /// to is believed: within a second of the last tracked frame, else after the frame found before.
  double fastest = 2.0;
  double fastest_turn = 3.0;
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
  bool carried = false;      ///< The pose is of the filter's odometry, the map was not found.
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

  /// Where the camera is expected at a time; nothing before the first frame and while it is lost.
  std::optional<MotionPrediction> predict(double timestamp) const;

  /// The last tracked frame, where the map has it now; null before the first one.
  const Frame* lastFrame() const noexcept { return last_ ? &*last_ : nullptr; }

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
                              const Eigen::Isometry3d& initial, MatchPolicy policy) const;
  std::optional<Eigen::Isometry3d> relocalize(const Frame& frame) const;
  Estimate findAgain(const Frame& frame, const KeyPointGrid& grid,
                     const std::vector<int>& candidates, const Relocalize& by_place) const;
  Estimate findNear(const Frame& frame, const KeyPointGrid& grid,
                    const std::vector<int>& candidates, const Eigen::Isometry3d& expected) const;
  bool needsKeyFrame(const Frame& frame) const;
  TrackingResult initialize(Frame frame);
  TrackingResult carryOrLose(Frame& frame, const KeyPointGrid& grid, TrackingFailure failure);
  TrackingResult goOn(Frame& frame, const KeyPointGrid& grid, TrackingResult result);
  TrackingResult lose(TrackingFailure failure);
  bool isBelievable(double timestamp, const Eigen::Isometry3d& found) const;
  bool isReachable(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to,
                   double seconds) const;
  void takePose(Frame& frame, const Estimate& found,
                const std::optional<MotionPrediction>& expected);
  void insertKeyFrame(Frame& frame, const KeyPointGrid& grid);
  void countSightings(const Frame& frame, const ProjectionSearch& search);

  PinholeCamera camera_;
  TrackerOptions options_;
  Map map_;
  std::optional<Frame> last_;  ///< The last tracked frame.
  MotionModel motion_;
  double last_match_ = 0.0;  ///< When the map was found last (s).
  bool lost_ = false;
  std::optional<std::pair<double, Eigen::Isometry3d>> unconfirmed_;  ///< Time (s) and pose.
  mutable PoseRefinementWorkspace workspace_;  ///< Memory only: changes no result.
};

}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
// What FrameFilter remembers of earlier frames.
#pragma once

#include <cmath>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include <hmcdyn/dynamic_feature_filter.hpp>
#include <hmcdyn/steps/optical_flow.hpp>
#include <hmcdyn/votes/motion_belief.hpp>

namespace hmcdyn::internal {

struct RememberedFrame {
  double timestamp = 0.0;
  FlowPyramid pyramid;
  MotionBelief belief;  ///< What was believed of that frame's points.
  std::optional<Eigen::Isometry3d> camera_from_world;
  bool pose_is_given = false;  ///< By the tracker; else it is what the filter itself found.
  /// The same camera in a world that no correction of a map moves: from pose to pose.
  Eigen::Isometry3d odometry = Eigen::Isometry3d::Identity();
};

class FrameHistory {
 public:
  /// @param baselines in rising order (s).
  explicit FrameHistory(std::vector<double> baselines) : baselines_(std::move(baselines)) {}

  /// Whether a frame with this time stamp comes after all that are remembered.
  bool follows(double timestamp) const noexcept {
    return std::isfinite(timestamp) && (frames_.empty() || timestamp > frames_.back().timestamp);
  }

  /// @throws std::invalid_argument for another image size than the last frame's.
  void checkSize(const cv::Size& size) const;

  /// For each baseline the youngest frame that is at least so old, each once, youngest first.
  std::vector<const RememberedFrame*> earlierThan(double timestamp) const;

  /// Remembers a frame, and forgets what no baseline reaches any more.
  void add(RememberedFrame frame);

  /// The images of a frame that was forgotten, for their memory; empty where there is none.
  FlowPyramid takeSpare() noexcept { return std::exchange(spare_, {}); }

  /// Where the camera is expected: on from the last two poses as between them.
  std::optional<Eigen::Isometry3d> predict(double timestamp) const;

  /// Where the filter itself finds the camera of a frame that was compared with `past`; where no
  /// pose at all is known, a new world begins with it.
  std::optional<Eigen::Isometry3d> poseFrom(const std::vector<const RememberedFrame*>& past,
                                            const std::vector<EarlierFrameReport>& reports);

  /// Whether poses are in the world of setPose() or, before that, of the first frame; not in one
  /// that began later.
  bool inCallersWorld() const noexcept { return in_callers_world_; }

  /// The camera of the next frame as RememberedFrame::odometry has it; nothing where the last
  /// frame has no pose to go on from.
  std::optional<Eigen::Isometry3d> odometryOf(const Eigen::Isometry3d& camera_from_world) const;

  /// @return the frame's odometry, if it is the last one and its pose was not given before.
  std::optional<Eigen::Isometry3d> setPose(double timestamp,
                                           const Eigen::Isometry3d& camera_from_world);
  void clear() noexcept {
    frames_.clear();
    in_callers_world_ = true;
  }

 private:
  std::vector<double> baselines_;
  std::deque<RememberedFrame> frames_;  ///< Oldest first.
  FlowPyramid spare_;
  bool in_callers_world_ = true;
};

/// Those frames as the filter takes them. They must outlive the result.
/// @param predicted pose of the current camera; with it and their own poses the camera's motion
/// since then is known.
std::vector<EarlierFrame> earlierFrames(const std::vector<const RememberedFrame*>& frames,
                                        double timestamp,
                                        const std::optional<Eigen::Isometry3d>& predicted);

}  // namespace hmcdyn::internal

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <hmcdyn/types.hpp>

#include "slam/loop/loop_key_frame.hpp"
#include "slam/loop/loop_verification.hpp"
#include "slam/loop/place_index.hpp"

namespace hmcdyn::slam {

struct LoopDetectorOptions {
  PlaceIndexOptions place;
  LoopVerificationOptions verification;
  std::size_t min_gap = 10;         ///< Candidates are at least this many key frames old.
  std::size_t max_candidates = 5;   ///< Looked at for a key frame, best place first.
  double min_score = 0.02;          ///< Of a candidate, 0..1.
  double min_relative_score = 0.3;  ///< Of a candidate, to the best among the key frames that see
                                    ///< the same points.
  /// Of a place's score, to the best place's; a place is a candidate with the key frames that see
  /// the same points, at most so many, those that look most alike.
  double min_relative_place = 0.75;
  std::size_t place_size = 10;  ///< >= 1
  /// Key frames in succession, this one included, whose candidates must overlap or share points.
  int min_consistent = 3;
  std::size_t cooldown = 5;  ///< Key frames after a loop in which none is looked for.
};

/// Two key frames that see the same place.
struct LoopConstraint {
  std::size_t from = 0;                                       ///< The older key frame.
  std::size_t to = 0;                                         ///< The newer one.
  Eigen::Isometry3d to_from = Eigen::Isometry3d::Identity();  ///< Camera `to` from camera `from`.
  /// Of delta = (rotation vector (rad), translation (m)) in the frame of `to`.
  Eigen::Matrix<double, 6, 6> information = Eigen::Matrix<double, 6, 6>::Identity();
  std::size_t inliers = 0;
  std::vector<std::pair<int, int>> key_points;  ///< Inliers: key point of `from`, of `to`.
  /// Map points that are one: that of `from`, that of `to`; where both have one and they differ.
  std::vector<std::pair<int, int>> map_points;
};

/// A candidate and what became of it.
struct LoopCandidate {
  std::size_t id = 0;
  double score = 0.0;            ///< Of the place index.
  double reference_score = 0.0;  ///< Of the best key frame that sees the same points.
  double place_score = 0.0;      ///< The sum over its place.
  int consistent = 0;            ///< Key frames in succession that point there, this one included.
  LoopVerification verification;
};

struct LoopReport {
  std::size_t id = 0;                     ///< The key frame that was processed.
  std::vector<LoopCandidate> candidates;  ///< Best place first, then those of low score.
  std::optional<LoopConstraint> constraint;
};

/// Looks for places that were seen before, a key frame at a time. Holds the key frames that it was
/// given (their descriptors are shared) and the index over them; owned by one thread.
///
/// A candidate is a key frame that looks alike, is old enough, shares no point with the current
/// one, and keeps up with the score of those that do (as in DBoW2, Galvez-Lopez and Tardos 2012,
/// without the normalisation). Scores of candidates that see the same points are added, since a
/// true place brings its neighbours, and the best of each place stands for it (as in ORB-SLAM,
/// Mur-Artal et al. 2015). Consecutive key frames must point to the same place, as ORB-SLAM
/// (Mur-Artal et al. 2015) asks; then verifyLoop() decides.
class LoopDetector {
 public:
  explicit LoopDetector(const PinholeCamera& camera, const LoopDetectorOptions& options = {});

  /// Looks for a loop to the key frame, then takes it in. The same sequence gives the same reports.
  /// @throws std::invalid_argument on an id that is known, see also checkLoopKeyFrame().
  LoopReport process(LoopKeyFrame key_frame);

  /// Forgets a key frame that was culled. False where it is not known.
  bool remove(std::size_t id);

  const PlaceIndex& index() const noexcept { return index_; }
  const std::map<std::size_t, LoopKeyFrame>& keyFrames() const noexcept { return key_frames_; }

 private:
  /// Candidates of a key frame with what they share points with, and for how long that has lasted.
  struct Group {
    std::set<std::size_t> members;
    int length = 1;
  };

  std::vector<LoopCandidate> candidatesOf(const LoopKeyFrame& key_frame) const;
  std::vector<LoopCandidate> placesAmong(const std::vector<LoopCandidate>& alike) const;
  int consistencyOf(const Group& group) const;
  Group groupOf(std::size_t id) const;
  std::optional<LoopConstraint> choose(const LoopKeyFrame& key_frame,
                                       std::vector<LoopCandidate>& candidates) const;
  void insert(LoopKeyFrame key_frame);

  PinholeCamera camera_;
  LoopDetectorOptions options_;
  PlaceIndex index_;
  std::map<std::size_t, LoopKeyFrame> key_frames_;
  std::map<std::size_t, std::size_t> order_;                // of insertion, by id
  std::map<std::size_t, std::set<std::size_t>> covisible_;  // symmetric
  std::vector<Group> groups_;                               // of the key frame before
  std::size_t processed_ = 0;
  std::optional<std::size_t> last_loop_;  // value of processed_
};

}  // namespace hmcdyn::slam

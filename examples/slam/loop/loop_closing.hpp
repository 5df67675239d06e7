// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <deque>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "slam/loop/loop_closer.hpp"
#include "slam/loop/loop_detector.hpp"
#include "slam/loop/map_snapshot.hpp"
#include "slam/loop/relocalizer.hpp"
#include "slam/map/map.hpp"
#include "support/worker.hpp"

namespace hmcdyn::slam {

struct LoopClosingOptions {
  bool enabled = true;
  LoopDetectorOptions detector;
  LoopCloserOptions closer;
  RelocalizerOptions relocalizer;
  /// A key frame's answer is taken up this many frames later, and waited for, so that runs repeat;
  /// so is a correction, at once. 0 = whenever it is there (real time).
  std::size_t delay = 2;
};

/// A loop candidate in the terms of time, once its fate is known.
struct LoopEvent {
  double timestamp = 0.0;          ///< Of the current key frame (s).
  double matched_timestamp = 0.0;  ///< Of the older one (s).
  double score = 0.0;
  std::size_t inliers = 0;
  std::string refusal;  ///< Empty = accepted, and closed.
};

/// Place recognition, loop detection and correction on a thread of their own. The thread owns the
/// index; what it needs of the map it is given as copies, and what it finds comes back as values.
class LoopClosing {
 public:
  LoopClosing(const PinholeCamera& camera, const LoopClosingOptions& options);

  /// Hands the latest key frame to the thread; where the thread is far behind, it is left out.
  void process(const Map& map);

  /// Call once a frame. A correction is of the whole map: one of a local adjustment that was begun
  /// before it is void.
  /// Rethrows what the thread's work threw; what threw is over and done with then, and the next
  /// call goes on: the loops that could not be closed are forgotten.
  std::optional<MapCorrection> poll(const Map& map);

  /// Waits for what is outstanding, and for the correction that it leads to; call it until it has
  /// none. Rethrows as poll() does.
  std::optional<MapCorrection> finish(const Map& map);

  /// Where a lost frame is; waits for the thread. Nothing where no place looks alike. Rethrows what
  /// this search threw; what the thread's earlier work threw, the next calls of poll() or finish()
  /// rethrow.
  std::optional<Eigen::Isometry3d> relocalize(const Frame& frame, const Map& map);

  /// Candidates since the last call.
  std::vector<LoopEvent> takeEvents();

  std::size_t loopsClosed() const noexcept;
  std::size_t keyFramesLeftOut() const noexcept { return left_out_; }

 private:
  struct State;  ///< The thread's own.
  struct DetectJob {
    LoopKeyFrame key_frame;
    std::vector<std::size_t> culled;  ///< Key frames to forget.
  };
  struct CloseJob {
    MapCopy map;
  };
  /// What became of a CloseJob: a correction, or a loop that is refused (place in the snapshot's
  /// loops), or an error, or none of these where it was stopped.
  struct Closed {
    std::optional<MapCorrection> correction;
    std::optional<std::size_t> refused;
    std::exception_ptr error;
  };
  struct RelocalizeJob {
    LoopKeyFrame frame;
  };
  /// Where a frame is, told from a key frame: the map may move that meanwhile.
  struct Relocalized {
    std::size_t key_frame = 0;
    std::optional<Eigen::Isometry3d> from_key_frame;
    std::exception_ptr error;
  };
  using Job = std::variant<DetectJob, CloseJob, RelocalizeJob>;
  using Answer = std::variant<LoopReport, Closed, Relocalized>;

  /// A loop that was found, and what is to be said of it.
  struct Loop {
    LoopConstraint constraint;
    LoopEvent event;
    bool closed = false;
  };

  static Answer run(State& state, const LoopClosingOptions& options, Job job);
  static Closed close(const MapCopy& map, const LoopCloserOptions& options);
  static Relocalized find(State& state, const LoopClosingOptions& options,
                          const LoopKeyFrame& frame);

  std::optional<MapCorrection> takeUp(Answer answer, const Map& map);
  std::optional<MapCorrection> takeUp(Closed closed);
  void note(const LoopReport& report, const Map& map);
  void submitClosure(const Map& map);
  void forget(const std::vector<std::size_t>& loops, const std::string& refusal);
  void rethrowKept();
  std::vector<std::size_t> newlyCulled(const Map& map);

  LoopClosingOptions options_;
  std::vector<Loop> loops_;             ///< Those that were not refused.
  std::vector<std::size_t> submitted_;  ///< Places in loops_ of the loops that are being closed.
  std::vector<LoopEvent> events_;
  MapCopier copier_;
  std::optional<Relocalized> relocalized_;
  /// Came up where they were not the answer to the question, in order.
  std::deque<std::exception_ptr> kept_errors_;
  std::vector<bool> forgotten_;  ///< Key frames that the thread need not know any more.
  std::size_t frames_waited_ = 0;
  std::size_t left_out_ = 0;
  bool closing_ = false;  ///< A correction is on its way.
  bool due_ = false;      ///< A loop was found meanwhile; its correction comes next.
  support::Worker<Job, Answer> worker_;
};

}  // namespace hmcdyn::slam

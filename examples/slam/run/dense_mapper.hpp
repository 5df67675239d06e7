// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <variant>
#include <vector>

#include <opencv2/core.hpp>

#include <hmcdyn/types.hpp>

#include "slam/map/map.hpp"
#include "slam/output/dense/dense_map.hpp"
#include "slam/run/pipeline.hpp"
#include "support/worker.hpp"

namespace hmcdyn::slam {

/// Collects key frames for the dense map on a thread of its own, without people and other things
/// that move.
class DenseMapper {
 public:
  DenseMapper();

  /// Hands over a key frame; waits where the thread is far behind. Then rethrows what the thread
  /// threw at one so far, which is not in the map.
  void add(std::size_t key_frame, const FrameOutcome& outcome);

  /// Waits for the thread. Rethrows as add() does: call it until it returns.
  void finish();

  /// The dense map with the poses that the key frames have now; after finish().
  FusionResult fuse(const Map& map);

 private:
  struct Job {
    std::size_t key_frame = 0;
    cv::Mat bgr;
    cv::Mat depth;
    std::vector<DetectionBox> boxes;
    cv::Mat labels;  ///< Of the detector, in place of the boxes; or empty.
    cv::Mat motion;  ///< Labels of the motion mask, in place of whole boxes; empty = none.
    std::vector<cv::Point2f> dynamic_points;
  };

  static cv::Mat staticMaskOf(const Job& job);

  std::shared_ptr<DenseMap> dense_;  ///< The thread's, until the queue is empty.
  support::Worker<Job, std::monostate> worker_;
};

}  // namespace hmcdyn::slam

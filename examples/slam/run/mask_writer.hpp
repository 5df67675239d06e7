// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <variant>

#include <opencv2/core.hpp>

#include "slam/run/options.hpp"
#include "slam/run/pipeline.hpp"
#include "support/worker.hpp"

namespace hmcdyn::slam {

/// Writes motion masks and the depth of what does not move (--write-masks, --write-static-depth) on
/// a thread of its own: to encode them takes longer than to make them.
class MaskWriter {
 public:
  /// Makes the folders; files in them are replaced where frames have the same stamps.
  /// @param depth_factor what 1 m is in the depth images. Above 0.
  /// @throws std::runtime_error naming the folder and the reason where one cannot be made.
  MaskWriter(const SlamOptions& options, double depth_factor);

  /// Hands over a frame; waits where the thread is eight frames behind. A frame without a motion
  /// mask gets one that is unknown everywhere. Then rethrows what the thread threw at one so far,
  /// which has no file.
  void add(const FrameOutcome& outcome);

  /// Waits for the thread. Rethrows as add() does: call it until it returns.
  void finish();

 private:
  struct Job {
    double timestamp = 0.0;
    cv::Mat label;
    cv::Mat depth;
  };

  support::Worker<Job, std::monostate> worker_;
};

}  // namespace hmcdyn::slam

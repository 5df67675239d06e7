// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include <hmcdyn/types.hpp>

namespace hmcdyn::slam {

struct BoxCarrierOptions {
  double max_age = 0.5;  ///< A box is carried on for so long without a detection (s); 0 = never.
  double min_overlap = 0.3;  ///< Intersection over union from which a detection is that box, 0..1.
  /// Two detections of one class are one thing when the smaller lies in the larger by this share
  /// ...
  double double_overlap = 0.85;
  /// ... and has at least this share of its area: a child before its mother is smaller.
  double double_area = 0.4;

  int grid = 9;                  ///< Points a side that are followed in a box.
  std::size_t min_points = 8;    ///< With fewer left, the box is given up.
  float max_difference = 15.0f;  ///< A point whose window differs by more is lost (gray levels).
  float layer_depth = 0.4f;      ///< Points up to so far behind the box's near ones count (m).
  double history = 1.0;          ///< Images are kept for late detections for so long (s).
};

/// A detection with the frame that it was made on.
struct TimedDetection {
  double timestamp = 0.0;  ///< Of the frame (s).
  std::vector<DetectionBox> boxes;
};

/// Carries boxes from frame to frame by the optical flow of the nearest points in them, so that a
/// missed detection leaves no gap and a late one is brought to the present. Missed detections are
/// what costs published systems most on walking_rpy (Hu et al., CFP-SLAM, 2022).
///
/// One instance serves one stream of frames in order. The same frames and detections give the same
/// boxes.
class BoxCarrier {
 public:
  /// @throws std::invalid_argument on options out of range.
  explicit BoxCarrier(const BoxCarrierOptions& options = {});

  /// The boxes of the next frame.
  /// @param gray CV_8UC1, not changed later. @param depth CV_32FC1 (m), 0 = none; may be empty.
  /// @param detected what a detector found in this frame or an earlier one that is still
  /// remembered; nothing = no answer. An empty list is an answer: nothing was seen.
  std::vector<DetectionBox> update(double timestamp, const cv::Mat& gray, const cv::Mat& depth,
                                   const std::optional<TimedDetection>& detected);

  std::size_t carried() const noexcept { return carried_; }  ///< Boxes without own detection.
  std::size_t merged() const noexcept { return merged_; }    ///< Doubles that were dropped.

 private:
  struct Image {
    double timestamp = 0.0;
    cv::Mat gray;
    cv::Mat depth;
  };
  struct Track {
    DetectionBox box;
    double seen = 0.0;  ///< Time stamp of the last detection (s).
  };

  std::vector<DetectionBox> withoutDoubles(const std::vector<DetectionBox>& boxes);
  std::vector<Track> carry(const std::vector<Track>& tracks, const Image& from,
                           const Image& to) const;
  std::vector<Track> associate(std::vector<Track> tracks, const TimedDetection& detected,
                               const Image* before, const Image& at);
  std::size_t imageAt(double timestamp) const;

  BoxCarrierOptions options_;
  std::deque<Image> images_;
  std::deque<std::vector<Track>> tracks_;  ///< At each of images_.
  std::size_t carried_ = 0;
  std::size_t merged_ = 0;
};

/// Intersection over union, 0..1; 0 for an empty or inverted box.
double overlap(const DetectionBox& a, const DetectionBox& b);

}  // namespace hmcdyn::slam

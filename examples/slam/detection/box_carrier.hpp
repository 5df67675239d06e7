// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include <hmcdyn/optical_flow.hpp>
#include <hmcdyn/types.hpp>

#include "slam/dataset/frame.hpp"

namespace hmcdyn::slam {

/// Boxes and regions are followed on images of half the size: their flow needs no more.
inline constexpr float kFlowScale = 0.5f;

struct BoxCarrierOptions {
  /// A box that the detector missed is bridged until it was not detected for so long (s); 0 = a
  /// missed box ends at once.
  double max_bridge = 0.5;
  /// Only boxes detected so many times are bridged: a false alarm is not made to last. At least 1.
  int min_detections = 2;
  /// Without a newer detection, boxes are carried on for so long at most (s).
  double max_carry = 2.0;
  double history = 1.0;        ///< Age of the oldest frame that a late detection may refer to (s).
  int grid = 7;                ///< Points followed along each side of a box; at least 3.
  std::size_t min_points = 6;  ///< Fewer followed points of the thing, and the box ends.
  float min_followed = 0.4f;   ///< The same as a share of the thing's points, 0..1.
  float max_scatter = 5.0f;    ///< Median deviation of the points' motion from the box's (px).
  float depth_band = 0.5f;     ///< The thing's points lie within its depth +- this (m).
  float depth_gap = 0.25f;     ///< Depths farther apart belong to different layers (m).
  float min_layer_share = 0.2f;  ///< A layer with fewer of the box's points is not the thing.
  float association_iou = 0.3f;  ///< Least overlap of a carried box with the detected one.
  /// Of two boxes of one class, the weaker goes where the intersection over the smaller area is
  /// above duplicate_overlap and the areas' ratio is above duplicate_size; 1 = both stay.
  float duplicate_overlap = 0.8f;
  float duplicate_size = 0.5f;
  /// A missed box of which more than this share lies in a detected one of its class is not bridged.
  float max_covered = 0.5f;
  float min_visible = 0.3f;  ///< A box of which less is in the image has left it.
  OpticalFlowOptions flow;   ///< On images of half the size.
};

/// What a detector said about a frame, perhaps an earlier one.
struct FrameDetection {
  std::size_t frame = 0;  ///< RgbdFrame::index.
  std::vector<DetectionBox> boxes;
};

/// Carries detected boxes to later frames by the flow of points in them: the median-flow tracker
/// (Kalal, Mikolajczyk, Matas, ICPR 2010) on those points of a grid that lie in the depth layer of
/// the thing, since a box holds background, too. A detection of an earlier frame is carried to the
/// present through the frames between; one that the detector missed is bridged for a while. Used by
/// one thread; the same calls give the same boxes.
class BoxCarrier {
 public:
  /// @throws std::invalid_argument for an option out of its range.
  explicit BoxCarrier(const BoxCarrierOptions& options = {});

  /// The boxes in this frame, clipped to it: those detected in it first, as they were detected and
  /// in their order, then those carried on.
  /// @param frame gray and depth (m, 0 = none; may be empty), time stamps that grow. A frame of
  /// another size than the one before, or whose stamp does not grow, forgets all boxes.
  /// @param detection the newest answer of the detector, of this frame or an earlier one; without
  /// a value it said nothing. One older than the history is left out.
  std::vector<DetectionBox> update(const RgbdFrame& frame,
                                   const std::optional<FrameDetection>& detection);

  /// Boxes of the last frame that are carried on though the newest detection missed them.
  std::size_t bridged() const noexcept { return bridged_; }

 private:
  struct Moment {
    std::size_t index = 0;
    double timestamp = 0.0;
    cv::Size size;
    FlowPyramid pyramid;
    cv::Mat depth;
  };
  struct Track {
    DetectionBox box;          ///< Not clipped.
    double detected_at = 0.0;  ///< Time stamp of the last frame it was detected in (s).
    int detections = 1;
    float depth = kNaN;   ///< Of the thing (m).
    bool missed = false;  ///< The newest detection does not have it.
    bool fresh = true;    ///< Detected in the present frame.
  };

  void remember(const RgbdFrame& frame);
  bool carry(Track& track, const Moment& from, const Moment& to) const;
  void carryAll(std::vector<Track>& tracks, const Moment& from, const Moment& to) const;
  std::vector<Track> tracksAt(std::size_t moment, const std::vector<DetectionBox>& boxes) const;
  void associate(std::vector<Track> detected);
  bool hasEnded(const Track& track, const Moment& now) const;

  BoxCarrierOptions options_;
  std::deque<Moment> history_;  ///< Oldest first; the last one is the present.
  std::vector<Track> tracks_;
  std::size_t bridged_ = 0;
};

/// Intersection over union of two boxes, 0..1; 0 where one has no area.
float intersectionOverUnion(const DetectionBox& a, const DetectionBox& b);

/// Leaves out the weaker one of each two boxes that show one thing (BoxCarrierOptions); of equal
/// scores the larger stays. Keeps the order.
std::vector<DetectionBox> mergeDoubles(const std::vector<DetectionBox>& boxes,
                                       const BoxCarrierOptions& options);

}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
// Boxes in frames that the detector missed, or has not seen yet. [OpenCV]
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include <opencv2/core.hpp>

#include <hmcdyn/detail/requirements.hpp>
#include <hmcdyn/steps/optical_flow.hpp>
#include <hmcdyn/types.hpp>

namespace hmcdyn {

/// How long boxes are carried on, and by what.
struct BoxCarrierOptions {
  /// A box that the detector missed is bridged until it was not detected for so long (s); 0 = a
  /// missed box ends at once.
  double max_bridge = 0.5;
  /// Only boxes detected so many times are bridged. At least 1: a detector that sees every fifth
  /// frame misses each box four times before it confirms it; what moves in a false alarm's box is
  /// judged by its motion, as in any.
  int min_detections = 1;
  double history = 1.0;        ///< Age of the oldest frame that a late detection may refer to (s).
  int grid = 7;                ///< Points followed along each side of a box; at least 3.
  std::size_t min_points = 6;  ///< Fewer followed points of the thing, and the box ends.
  /// Of two boxes of one class, one not much smaller than the other, the weaker goes where the
  /// intersection over the smaller area is above this share; 1 = both stay.
  float duplicate_overlap = 0.8f;
  OpticalFlowOptions flow;  ///< On images of half the size.
};

/// A frame as boxes are carried through it.
struct CarriedFrame {
  std::size_t index = 0;   ///< Its number, by which detections refer to it.
  double timestamp = 0.0;  ///< (s)
  cv::Mat gray;            ///< CV_8UC1; what is needed of it is copied.
  cv::Mat depth;           ///< CV_32FC1 (m), 0 = none; may be empty. Kept, not copied.
};

/// What a detector said about a frame, perhaps an earlier one.
struct FrameDetection {
  std::size_t frame = 0;            ///< CarriedFrame::index.
  std::vector<DetectionBox> boxes;  ///< What it found.
};

/// Carries detected boxes to later frames by the flow of points in them: the median-flow tracker
/// (Kalal, Mikolajczyk, Matas, ICPR 2010) on those points of a grid that lie in the depth layer of
/// the thing, since a box holds background, too. A detection of an earlier frame is carried to the
/// present through the frames between, for two seconds at most; one that the detector missed is
/// bridged for a while. Used by one thread; the same calls give the same boxes.
class BoxCarrier {
 public:
  /// @throws std::invalid_argument for an option out of its range.
  explicit BoxCarrier(const BoxCarrierOptions& options = {});

  /// The boxes in this frame, clipped to it: those detected in it first, as they were detected and
  /// in their order, then those carried on.
  /// @param frame whose time stamp grows: one of another size than the one before, or whose stamp
  /// does not grow, forgets all boxes.
  /// @param detection the newest answer of the detector, of this frame or an earlier one; without
  /// a value it said nothing. One older than the history is left out.
  std::vector<DetectionBox> update(const CarriedFrame& frame,
                                   const std::optional<FrameDetection>& detection);

  /// Forgets all frames and boxes.
  void reset() noexcept;

  /// Boxes of the last frame that are carried on though the newest detection missed them.
  std::size_t bridged() const noexcept { return bridged_; }

 private:
  /// @cond its own
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
  /// @endcond

  void remember(const CarriedFrame& frame);
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

/// The boxes cut to the pixels 0..cols - 1 and 0..rows - 1; one that is wholly outside is left
/// out. An inverted box (a maximum below its minimum) holds no point and is kept as it is.
std::vector<DetectionBox> clipToImage(const std::vector<DetectionBox>& boxes, cv::Size image);

/// Intersection over union of two boxes, 0..1; 0 where one has no area.
float intersectionOverUnion(const DetectionBox& a, const DetectionBox& b);

/// Leaves out the weaker one of each two boxes that show one thing (BoxCarrierOptions); of equal
/// scores the larger stays. Keeps the order.
std::vector<DetectionBox> mergeDoubles(const std::vector<DetectionBox>& boxes,
                                       const BoxCarrierOptions& options);

}  // namespace hmcdyn

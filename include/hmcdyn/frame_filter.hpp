// SPDX-License-Identifier: BSD-3-Clause
// The library as a SLAM front end calls it: one object, one call a frame. [OpenCV]
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

#include <hmcdyn/detail/requirements.hpp>
#include <hmcdyn/dynamic_feature_filter.hpp>
#include <hmcdyn/motion_mask.hpp>
#include <hmcdyn/pose.hpp>
#include <hmcdyn/regions.hpp>
#include <hmcdyn/steps/box_carrier.hpp>
#include <hmcdyn/types.hpp>

namespace hmcdyn {

/// What FrameFilter does with a frame. Two sets of values: robust(), which is the default, and
/// paper().
struct FrameFilterOptions {
  FilterRule rule = FilterRule::kHmc;  ///< Who decides; the others are those of peers.
  /// With it, and a depth camera, the filter makes a motion mask of each frame (motion_mask.hpp),
  /// which has the first word on each point, and knows how the camera moves where people cover the
  /// image: from poses that it is given (FrameFilter::setPose, FrameInput::predicted_pose), else
  /// from its own. fx = 0: by two-view models alone.
  PinholeCamera camera;
  /// Ages (s) of the earlier frames to compare with; for each, the youngest frame that is at least
  /// so old. 0 = the neighbour. A slow person shows over the longer baseline only.
  std::vector<double> baselines = {0.0, 0.1};
  /// Key points that optical flow, the dearest step, follows into each earlier frame: five of nine
  /// in boxes, the others for the camera's motion; the rest is judged by its neighbours. 0 = all,
  /// and in frames without a box, too. (In boxes it is all as well where nobody votes: by the
  /// peers' rules, and without a depth image.)
  int max_followed = 450;
  /// Where fewer points than this would be kept, the least moving, least certain ones are kept as
  /// well, up to so many, at the weight kRescueWeight: a tracker that is starved is lost for long.
  /// 0 = never.
  int min_kept = 100;
  /// Boxes that the detector missed are carried on by optical flow for so long (s); 0 = never.
  double bridge = 0.5;
  /// Where there is no earlier frame to compare with, points in boxes are dropped: else the people
  /// in the first frame would enter the first map.
  bool drop_boxes_without_history = true;
  /// Above this share of points in dynamic boxes, 0..1, the refinement's weights are eq. 7's; below
  /// it, and always at 1, they are 0 and 1 only.
  double soft_weight_gate = 0.6;
  std::uint32_t seed = 1;              ///< Of every random draw.
  DynamicFeatureFilterOptions expert;  ///< The steps, for what no field above has; see steps().

  /// What filterDynamicFeatures() is called with: `expert`, in which rule, seeds and how many
  /// points are followed are those of the fields above.
  DynamicFeatureFilterOptions steps() const;

  /// The paper's method and nothing of ours: one neighbouring frame; F from all matches; every key
  /// point followed; the mean distance of all of them in the rough screening; no floors; no votes,
  /// no memory, no surface depth, no bridging, no first-frame rule, nobody kept by number; points
  /// without a match are judged by nothing; eq. 7-10 with the gate of 0.6.
  static FrameFilterOptions paper();
  /// What is best on real images: the defaults.
  static FrameFilterOptions robust() { return {}; }
};

/// Weight for the refinement of a point that FrameFilterOptions::min_kept keeps: a hundred of them
/// weigh as one that is trusted.
inline constexpr float kRescueWeight = 0.1f;

/// Parts of the method that are taken away, to see what they are worth (tables I and II of the
/// paper).
enum class Ablation : std::uint8_t {
  kNone,  ///< Nothing is.
  kRs,    ///< Without region splitting: every point in a dynamic box is dropped.
  /// Without the cluster filter: one threshold on each point's distance. Eq. 7 has no anchor then,
  /// so weights are 0 and 1.
  kDf,
  kOpw,  ///< Without weights in the refinement: 0 and 1; lambda, and so the map, stays as it is.
};

/// "none", "rs", "df" or "opw".
const char* toString(Ablation ablation) noexcept;

/// The options without a part of the method; paper() and robust() alike.
FrameFilterOptions without(Ablation ablation, FrameFilterOptions options);

/// What a front end holds once its key points have depths. Image, depth and key points are of one
/// undistorted (rectified) camera.
struct FrameInput {
  double timestamp = 0.0;  ///< (s), above the last frame's.
  cv::Mat gray;            ///< CV_8UC1; what is needed of it is copied.
  /// CV_32FC1 (m), of the image's size; 0 or NaN = none. Empty = no depth camera: no beliefs.
  cv::Mat depth;
  Span<const cv::KeyPoint> key_points;  ///< N.
  /// N depths (m), as your system reads them (ORB-SLAM's mvDepth); 0, negative or NaN = none.
  /// Empty = the depth image's nearest pixels.
  Span<const float> point_depth = {};

  /// Where your motion model expects the camera in this frame (camera from world), if it does: what
  /// is known of the camera where people cover the image. See FrameFilter::setPose(). Without it
  /// the filter goes on from the last two poses.
  std::optional<Pose> predicted_pose = std::nullopt;

  /// Your own matches with an earlier frame, which save optical flow: the time stamp of that frame,
  double matched_timestamp = 0.0;
  /// and N pixels in it; NaN = not matched, and followed by flow. Empty = none.
  Span<const cv::Point2f> matched_pixels = {};
};

/// How much a result is worth.
enum class FrameFilterStatus : std::uint8_t {
  kFiltered,       ///< Compared with earlier frames.
  kNothingToDo,    ///< No box, and nothing that moved before: all points are static.
  kNoHistory,      ///< The first frame: nothing to compare with.
  kCameraUnknown,  ///< Boxes cover so much, and so little is known, that nobody can tell how the
                   ///< camera moved: points outside the boxes are kept, those in them are a guess.
  kStampNotRising  ///< The time stamp is not above the last one's, or not finite: the frame was
                   ///< neither compared nor remembered. reset() before another sequence.
};

/// "filtered", "nothing to do", "no history", "camera unknown" or "time stamp does not rise".
const char* toString(FrameFilterStatus status) noexcept;

/// Why a point was kept or dropped.
enum class PointReason : std::uint8_t {
  kOutside,     ///< Outside everything that may move.
  kAtRest,      ///< In a box, of which nothing moves.
  kApart,       ///< In a box that moves, and not with it: weighed by lambda.
  kMoves,       ///< By its own distance.
  kMovesAlong,  ///< By its cluster, its neighbours, or what was believed of them before.
  kRoom,        ///< In a box, but the motion mask knows it to be of the room.
  kMask,        ///< The motion mask says that it moves.
  kNoHistory,   ///< In a box, and no earlier frame tells whether it moves: dropped.
  kForNumber,   ///< Dropped by one of these reasons, but too few were left (min_kept).
};

/// "outside", "at rest", "apart", "moves", "moves along", "room", "mask", "no history" or "for
/// number".
const char* toString(PointReason reason) noexcept;

/// What became of a frame's N key points.
struct FrameFilterResult {
  FrameFilterStatus status = FrameFilterStatus::kFiltered;  ///< What the result is worth.
  std::vector<std::uint8_t> keep;  ///< N flags: 0 = on a moving thing, drop it.
  /// N weights for the pose refinement, 0..1; 0 = dropped. Below the gate 0 and 1 only.
  std::vector<float> weight;
  /// N values of eq. 7, 0..1, whatever the gate says: how far a point is trusted to stand still. A
  /// map should ask this one before it makes a landmark of a point.
  std::vector<float> lambda;
  std::vector<PointLabel> label;    ///< N verdicts.
  std::vector<PointReason> reason;  ///< N reasons.
  std::vector<MaskLabel> mask;      ///< What the motion mask says at the N points; empty = no mask.
  bool soft_weights = false;        ///< `weight` is `lambda`, not 0 and 1 only.
  std::size_t kept = 0;             ///< Points whose flag is not 0 ...
  std::size_t kept_for_number = 0;  ///< ... and those of them that min_kept kept.
  std::vector<DetectionBox>
      boxes;                ///< The boxes that were judged: the detector's, then bridged ones.
  std::size_t bridged = 0;  ///< How many of these the detector missed.
  /// Where the filter itself finds the camera, for a front end that finds too little of its map:
  /// the pose of an earlier frame and the motion since then of points with depth that are believed
  /// to be at rest. In the world of setPose(), else in that of the first frame; nothing where the
  /// motion or the world is unknown.
  std::optional<Pose> camera_from_world;
  DynamicFeatureFilterResult details;  ///< Distances, clusters, beliefs, models.
};

/// Filters frame after frame. Owns what the filter needs of earlier frames (images, beliefs,
/// boxes), since a tracker overwrites its own. One object a camera, one thread at a time; starts no
/// thread (OpenCV's optical flow uses OpenCV's pool). The same calls give the same results.
class FrameFilter {
 public:
  /// @throws std::invalid_argument for an option out of its range.
  explicit FrameFilter(FrameFilterOptions options = {});
  ~FrameFilter();                                        ///< Frees what is remembered.
  FrameFilter(FrameFilter&& other) noexcept;             ///< Takes the memory over.
  FrameFilter& operator=(FrameFilter&& other) noexcept;  ///< The same.
  FrameFilter(const FrameFilter&) = delete;
  FrameFilter& operator=(const FrameFilter&) = delete;

  /// Filters the frame's key points by a detector's boxes or a mask, and remembers the frame. By a
  /// mask a point belongs to the region at its pixel; the background in a person's box is none of
  /// it. Masks are not bridged.
  /// @throws std::invalid_argument for an image of the wrong type or size, arrays of unequal sizes,
  /// boxes and a mask at once, or a bad option; the frame is then not remembered.
  FrameFilterResult filter(const FrameInput& frame, const Regions& regions);

  /// The same where the detector has not said anything about this frame (it is slower than the
  /// camera): its last boxes are carried on, for two seconds at most.
  FrameFilterResult filter(const FrameInput& frame);

  /// Where the camera was in a frame that was filtered (camera from world), once it is tracked. A
  /// frame that has a pose already was moved with the world (a map correction), and so were those
  /// before it. A time stamp that is not remembered is ignored.
  void setPose(double timestamp, const Pose& camera_from_world);

  /// Forgets all frames. Only where time jumps or another sequence begins: what is remembered is of
  /// images, so a new map of the same stream is no reason.
  void reset() noexcept;

  /// The motion mask of the last frame; null where none is made (no camera, no depth image,
  /// paper()). Valid until the next call.
  const MotionMask* mask() const noexcept;

  /// As given, baselines in rising order.
  const FrameFilterOptions& options() const noexcept;

 private:
  struct Memory;
  std::unique_ptr<Memory> memory_;
};

/// Part of the image that boxes cover, 0..1; what several cover counts once.
double coveredShare(Span<const DetectionBox> boxes, const cv::Size& image);

/// How many times as many key points to extract so that about as many as usual lie outside the
/// boxes, 1..max_factor: with people on half of the image a perfect filter would otherwise leave
/// too few.
/// @throws std::invalid_argument unless max_factor >= 1.
double featureFactor(Span<const DetectionBox> boxes, const cv::Size& image,
                     double max_factor = 2.5);

}  // namespace hmcdyn

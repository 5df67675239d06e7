// SPDX-License-Identifier: BSD-3-Clause
// Per pixel, what moves: from depth images, the camera's poses and memory; boxes help. [OpenCV]
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include <opencv2/core/mat.hpp>

#include <hmcdyn/depth_error.hpp>
#include <hmcdyn/detail/requirements.hpp>
#include <hmcdyn/label_image.hpp>
#include <hmcdyn/pose.hpp>
#include <hmcdyn/regions.hpp>
#include <hmcdyn/types.hpp>

namespace hmcdyn {

/// What a pixel of MotionMask::label says.
enum class MaskLabel : std::uint8_t {
  kStatic = 0,      ///< The room.
  kUnknown = 64,    ///< Nothing to judge by: no depth, out of range, nothing to compare with.
  kStanding = 128,  ///< At rest, but it moved before, or a box or mask names it.
  kMoving = 255,    ///< Moves.
};

/// Options of the motion mask. What else it goes by are constants of its model, in
/// docs/parameters.md.
struct MotionMaskOptions {
  int working_width = 160;  ///< Images are judged at about this width (px), at least 16.
  float max_depth = 4.0f;   ///< Farther pixels (m) are not judged: depth cameras err by too much.
  DepthErrorModel depth_error;  ///< Of the depth camera.
  /// A gray level outside the range of the 3 x 3 pixels where a static surface was, by more than
  /// this, is not that surface; where the mean of the whole image has changed by more, gray levels
  /// say nothing. Of exposures that drift; 255 = ignore the gray image.
  float gray_tolerance = 20.0f;
  float min_area = 0.003f;  ///< Smaller things (share of the image) are noise.
  /// Masks that cover more than this share of the pixels with depth are reported.
  float max_moving_share = 0.75f;
  double max_age = 2.4;  ///< Older frames are forgotten (s).
  double max_gap = 1.0;  ///< After a longer time without a frame, all is forgotten (s).
};

/// @throws std::invalid_argument naming the first option out of range.
void checkOptions(const MotionMaskOptions& options);

/// One frame's input; borrowed for the call.
struct MotionMaskFrame {
  double timestamp = 0.0;  ///< (s)
  cv::Mat depth;           ///< CV_32FC1 (m); 0, negative or not finite = none. Not empty.
  cv::Mat gray = {};       ///< CV_8UC1, of the same size; empty = judged by depth alone.
  /// Takes points of the world to the camera's frame (m), as everywhere in the library; any world
  /// that does not jump will do.
  Pose camera_from_world;
  bool pose_is_known = true;             ///< False: the frame cannot be compared.
  Regions regions = {};                  ///< Things that may move; may be empty.
  KeyPointsView points = {};             ///< Key points with a verdict; may be empty.
  Span<const PointLabel> verdicts = {};  ///< One a key point. kDynamic counts.
};

/// How sure the mask is as a whole.
enum class MaskState : std::uint8_t {
  kGood,           ///< Compared with earlier frames.
  kFirstFrame,     ///< Nothing to compare with: first frame, new size, or after one of those below.
  kTimeJump,       ///< The stamp did not grow, or by too much: all before is forgotten.
  kCameraJump,     ///< The pose jumped: all before is forgotten.
  kMotionUnknown,  ///< pose_is_known is false, or the pose is not finite; the frame is left out.
  kMotionDoubtful,  ///< Hardly a surface is where the motion puts it; all before is forgotten.
  kNoDepth,         ///< Too few depths; the frame is left out.
  kTooLarge,        ///< The mask covers more than max_moving_share. It is given all the same.
};

/// "good", "first frame", "time jump", "camera jump", "motion unknown", "motion doubtful",
/// "no depth" or "too large".
const char* toString(MaskState state) noexcept;

/// What a thing was told from the room by: the strongest of these.
enum class MaskReason : std::uint8_t {
  kFreeSpace,  ///< It stands where there was nothing.
  kGray,       ///< Depth does not tell, but what is seen there changed.
  kMemory,     ///< It moved before.
  kNamed,      ///< A box, a mask or key points.
};

/// "free space", "gray", "memory" or "named".
const char* toString(MaskReason reason) noexcept;

/// A thing that moves or moved.
struct MaskInstance {
  int number = 0;      ///< The same from frame to frame while it is seen; from 1.
  cv::Rect box;        ///< Around its pixels (px of the whole image).
  bool moves = false;  ///< Or it stands.
  float area = 0.0f;   ///< Share of the image.
  float depth = 0.0f;  ///< Mean depth (m).
  std::array<float, 3> velocity = {0, 0, 0};  ///< Mean, in the world (m/s); 0 where it stands ...
  bool has_velocity = false;                  ///< ... or could not be measured (false).
  MaskReason decided_by = MaskReason::kFreeSpace;  ///< By what it was told from the room.
};

/// What is known about a frame.
struct MotionMask {
  MaskState state = MaskState::kFirstFrame;  ///< Read it first.
  cv::Mat label;                             ///< CV_8UC1 of the frame's size: values of MaskLabel.
  cv::Mat belief;  ///< CV_32FC1 at working size: -1 static .. 1 moves or moved; 0 = unknown.
  std::vector<MaskInstance> instances;  ///< Largest first.
  float moving_share = 0.0f;            ///< Share of moving pixels among all of the image.
  /// Share of surfaces that are where the camera's motion puts them, of those that could be.
  float agreement = 1.0f;
};

/// Finds what moves in a stream of depth images with known camera poses, without knowing what a
/// thing is.
///
/// Each surface is taken into earlier frames (0.03 to 2 s back) by the camera's motion. Where that
/// frame saw *through* the place, it was free: the surface has come since. (Residuals of a moved
/// surface against an older view of the scene: ReFusion, Palazzolo et al., IROS 2019; free space as
/// proof: Dynablox, Schmid et al., RA-L 2023.) Where it saw a surface, the present one is what that
/// one was believed to be, a little more static. Where a nearer surface hid the place, or no depth
/// was measured, nothing is known. The other way round, an earlier surface whose place is free now
/// has left; what has its depth beside that place is what moved. What single pixels say is averaged
/// along surfaces, never across depth edges (normalised convolution, Knutsson and Westin 1993, by
/// recursive edge-aware filters, Gastal and Oliveira 2011). Pixels believed to move that hang
/// together are things; a thing moves, or stands, by the youngest comparisons. All at about 160
/// columns; the mask is carried to the whole image by depth, pixel for pixel where labels meet.
///
/// Poses come from the caller. Memory of 2.4 s at 30 Hz takes some 8 MB. Buffers are reused: in the
/// steady state nothing grows. One thread; the same frames give the same masks.
class MotionMaskEstimator {
 public:
  /// @throws std::invalid_argument for a focal length that is not above 0, or a bad option.
  explicit MotionMaskEstimator(const PinholeCamera& camera, const MotionMaskOptions& options = {});
  ~MotionMaskEstimator();
  MotionMaskEstimator(MotionMaskEstimator&& other) noexcept;             ///< Takes the memory over.
  MotionMaskEstimator& operator=(MotionMaskEstimator&& other) noexcept;  ///< Takes the memory over.
  MotionMaskEstimator(const MotionMaskEstimator&) = delete;
  MotionMaskEstimator& operator=(const MotionMaskEstimator&) = delete;

  /// @return the mask of the frame; its images are written anew by the next call. An image of
  /// another size than before starts anew.
  /// @throws std::invalid_argument for an empty image or one of another type, images of unequal
  /// size, images smaller than 16 px, or unequal arrays.
  const MotionMask& update(const MotionMaskFrame& frame);

  /// Where the camera was in a frame that was updated (takes points of the world to the camera's
  /// frame), once it is known better than it was then: a tracker predicts before it tracks. Frames
  /// to come are compared with it there; the masks that were given stay. Other frames are not moved
  /// along, so after a correction of the map call reset(). A time stamp that is not remembered, and
  /// a pose that is not finite, are ignored.
  void setPose(double timestamp, const Pose& camera_from_world);

  /// Forgets all frames, as after a loop was closed.
  void reset();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Depth (m, CV_32FC1) without what moves and, if asked for, what stands but may move: 0 there.
/// @throws std::invalid_argument for images of unequal size or of another type.
cv::Mat staticDepth(const cv::Mat& depth, const cv::Mat& label, bool keep_standing = false);

}  // namespace hmcdyn

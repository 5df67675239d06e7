// SPDX-License-Identifier: BSD-3-Clause
// All the steps for one frame against one or several earlier ones, in order. [OpenCV]
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <opencv2/core/mat.hpp>

#include <hmcdyn/detail/requirements.hpp>
#include <hmcdyn/filter_stage.hpp>
#include <hmcdyn/label_image.hpp>
#include <hmcdyn/pose.hpp>
#include <hmcdyn/regions.hpp>
#include <hmcdyn/steps/ego_motion.hpp>
#include <hmcdyn/steps/fundamental.hpp>
#include <hmcdyn/steps/optical_flow.hpp>
#include <hmcdyn/types.hpp>
#include <hmcdyn/votes/belief_verdict.hpp>
#include <hmcdyn/votes/motion_belief.hpp>
#include <hmcdyn/votes/surface_depth.hpp>

namespace hmcdyn {

/// Which distance the filter judges by.
enum class DistanceKind : std::uint8_t {
  kTwoView,    ///< Epipolar distance, eq. 4, or the transfer distance where F is not defined.
  kEgoMotion,  ///< Compensated for a known camera motion, in three dimensions.
  kLarger,     ///< The larger of both.
};

/// The options of every step, and how much optical flow is spent.
struct DynamicFeatureFilterOptions {
  OpticalFlowOptions flow;                         ///< Step 1.
  TwoViewOptions two_view;                         ///< Step 2.
  DistanceKind distance = DistanceKind::kTwoView;  ///< Which distance step 3 measures.
  EgoMotionOptions ego_motion;                     ///< Step 3, for the ego-motion distance.
  FilterStageOptions stage;                        ///< Steps 4 to 7.

  /// Optical flow is the dearest step: only the points that need a distance get one. Those in a box
  /// or within this margin of one (px) do ...
  float flow_margin = 40.0f;
  /// ... up to so many, spread over the image, where beliefs are formed: the others are judged by
  /// their neighbours. 0 = all ...
  int flow_in_boxes = 250;
  /// ... and so many others, spread over the image, for the camera's motion. 0 = all of them, and
  /// in frames without a box, too.
  int flow_background = 200;

  /// Forms beliefs where the frame's depth image is given; not for the peers' rules.
  bool use_belief = true;
  SurfaceDepthOptions surface;          ///< On which surface a point lies.
  MotionBeliefOptions belief;           ///< How the points vote.
  BeliefVerdictOptions belief_verdict;  ///< What the votes decide.

  /// Where the matches outside the boxes do not determine a model,
  /// EarlierFrame::current_from_earlier speaks for the camera, where it is given: a few matches at
  /// the image's border, or a crowd, would not. false = as the paper has it: whatever most matches
  /// do is the camera's motion.
  bool require_known_camera = true;

  /// A model explains its frame pair well enough to speak of motion when the median distance of its
  /// matches stays below this (px); distances to other frames are not used.
  float max_median_distance = 0.5f;
};

/// An earlier frame to compare with. The neighbour shows fast motion; one some tenths of a second
/// back shows slow motion, too.
struct EarlierFrame {
  const FlowPyramid* pyramid = nullptr;  ///< Of its gray image; not null.
  /// Depths (m, CV_32FC1, 0 or NaN = none), of the image's size; needed for the ego-motion
  /// distance.
  cv::Mat depth;
  /// Motion of the camera since then, as far as it is known: needed for the ego-motion distance,
  /// and speaks for the camera where the matches do not, for which a prediction is exact enough.
  std::optional<Pose> current_from_earlier = std::nullopt;
  /// N columns (px) where the caller's own matching found the key points in this frame; NaN = not
  /// found, and optical flow looks for it. Empty = none. They must outlive the call.
  Span<const float> matched_u = {};
  Span<const float> matched_v = {};  ///< N rows; the same.
  /// Time since then (s); 0 = unknown. With it the flow to the frame before in the list, prolonged,
  /// is where the search starts.
  double age = 0.0;
};

/// One frame's input.
struct DynamicFeatureFilterInput {
  const FlowPyramid* pyramid = nullptr;  ///< Of the current gray image; not null.
  KeyPointsView points;                  ///< N key points of the current frame.
  Regions regions;                       ///< Of the current frame: boxes, or a mask.
  Span<const EarlierFrame> earlier;      ///< Frames to compare with; may be empty.
  PinholeCamera camera;                  ///< Needed where current_from_earlier is used.
  DepthImageView depth = {};             ///< Of the current frame (m); empty = no beliefs.
  /// `belief` of the result for earlier[0]; null = none.
  const MotionBelief* memory = nullptr;
};

/// What one earlier frame contributed.
struct EarlierFrameReport {
  FlowMatches flow;        ///< Where the N key points were.
  TwoViewEstimate motion;  ///< The model, and whether F was defined.
  bool used = false;       ///< Its distances count.
  /// Somebody knows how the camera moved: enough background, what earlier frames knew to be at
  /// rest, or a prediction. Else the model is of whatever most points do, a crowd perhaps, and
  /// points outside all boxes have no distance from it.
  bool camera_known = false;
  /// The motion of the camera since then, where one was predicted and could be made exact.
  std::optional<Pose> current_from_earlier = std::nullopt;
};

/// What the filter found out about a frame of N key points.
struct DynamicFeatureFilterResult {
  std::vector<float> distance;              ///< N distances (px), NaN = none.
  FilterStageResult stage;                  ///< Labels, weights, clusters; boxes and frame.
  std::vector<EarlierFrameReport> earlier;  ///< One an earlier frame.
  MotionBelief belief;  ///< The next frame's memory; empty where no beliefs are formed.
  /// There were earlier frames to compare with, but nobody knows how the camera moved
  /// (EarlierFrameReport::camera_known): points outside all boxes are not called dynamic.
  bool camera_unknown = false;
};

/// Memory that filterDynamicFeatures reuses from frame to frame.
struct DynamicFeatureFilterWorkspace {
  FilterStageWorkspace stage;    ///< Of steps 4 to 7.
  MotionBeliefWorkspace belief;  ///< Of the votes.
  std::vector<float> distance;   ///< Of one earlier frame (px).
  BoxMembership membership;      ///< Of the points that are followed.
};

/// Tracks the key points into every earlier frame, estimates the camera's motion, measures each
/// point's distance (the largest over the earlier frames whose model holds), labels and weighs the
/// points, and lets them vote on each other. Pure: the same input and seeds give the same result.
///
/// Where the matches outside the boxes do not determine it, a known motion
/// (EarlierFrame::current_from_earlier) speaks for the camera. Without one, points in boxes do as
/// well, but for those that the memory knows to move: a crowd would be taken for the world. Where
/// nothing of all that is known, points outside all boxes stay static, and the result says so.
///
/// Without a box and without a memory of something that moves there is nothing to decide: no flow
/// is computed, and all points are static (flow_background = 0 computes it all the same).
///
/// Without an earlier frame, or where no model holds, no point has a distance: all are static, and
/// the reports say why.
///
/// With masks a point belongs to the region at its nearest pixel: the background in a person's box
/// is none of it and stays static. Only where flow is spent, and which matches speak for the
/// camera's motion, is decided by the boxes around the regions, since a mask may end short of a
/// silhouette. A mask that fills its box gives the result of the box.
/// Points that the caller has matched already (EarlierFrame::matched_u) are not followed again.
/// @throws std::invalid_argument for a null pyramid, unequal arrays, images of unequal size, boxes
/// and labels at once, regions without labels, labels of another type, a
/// missing motion, depth or camera where the ego-motion distance is asked for, a memory of unequal
/// arrays, or a bad option.
DynamicFeatureFilterResult filterDynamicFeatures(const DynamicFeatureFilterInput& input,
                                                 const DynamicFeatureFilterOptions& options,
                                                 DynamicFeatureFilterWorkspace& workspace);

/// The smallest call: two gray images (8-bit, one size), key points and boxes.
/// @throws std::invalid_argument as above, and for images that are not 8-bit gray.
DynamicFeatureFilterResult filterDynamicFeatures(const cv::Mat& earlier_gray,
                                                 const cv::Mat& current_gray,
                                                 const KeyPointsView& points,
                                                 Span<const DetectionBox> boxes,
                                                 const DynamicFeatureFilterOptions& options = {});

/// The same with masks (regions.hpp, label_image.hpp).
/// @param labels CV_8UC1, CV_16UC1 or CV_32SC1, of the images' size. @param regions which labels
/// may move.
/// @throws std::invalid_argument as above, and for empty labels.
DynamicFeatureFilterResult filterDynamicFeatures(const cv::Mat& earlier_gray,
                                                 const cv::Mat& current_gray,
                                                 const KeyPointsView& points, const cv::Mat& labels,
                                                 Span<const LabelRegion> regions,
                                                 const DynamicFeatureFilterOptions& options = {});

}  // namespace hmcdyn

// SPDX-License-Identifier: BSD-3-Clause
// What the mask goes by: the caller's options, and the constants of its model. How they were
// chosen: docs/masks.md, docs/results.md.
#pragma once

#include <hmcdyn/motion_mask.hpp>

namespace hmcdyn::internal {

/// When an earlier depth contradicts the present one.
struct DepthModel {
  float gate = 3.0f;    ///< So many standard deviations of the measured error are error.
  float slack = 0.01f;  ///< Added to every threshold (m): errors beyond those measured.
};

/// How evidence is weighed and remembered.
struct EvidenceModel {
  float free_weight = 1.5f;  ///< Of a surface where there was free space.
  /// Of an earlier surface whose place is free now; counts for the surface of its depth beside it.
  float departure_weight = 1.0f;
  /// Of a surface that has not the gray level of the earlier one, times ln(0.3 / share of all
  /// surfaces that have not): 0 where light or exposure changed, at most 1 ...
  float mismatch_weight = 0.35f;
  /// ... and as it is, in frames with boxes or masks: those say more.
  float named_mismatch_weight = 0.15f;
  /// Weight of a surface that was there before: from `same_weight_young` for the frame before to 1
  /// for one of age `same_age` (s). Short ages say little: a moving surface covers itself.
  float same_weight_young = 0.4f;
  float same_age = 0.7f;  ///< (s)
  /// Of a surface that was there before, where neither its depth nor its gray level has an edge: it
  /// would look the same if it had moved along itself. (Share of the weight of one with an edge.)
  float plain_weight = 0.25f;
  float edge_gray = 40.0f;  ///< An edge: gray levels of 3 x 3 pixels that differ by this.
  /// A surface that stays drifts from what it was believed to be towards static by this a
  /// comparison (belief is -1 .. 1) ...
  float drift = 0.25f;
  /// ... and by this where a box or mask names it.
  float named_drift = 0.05f;
  float dynamic_point_weight = 1.0f;  ///< Of a key point that was found to move.
};

/// What becomes of evidence: pixels, things, mask.
struct SegmentModel {
  float reach = 8.0f;        ///< Of evidence along a surface (reduced pixels).
  float depth_step = 0.02f;  ///< Neighbours that differ by this share of their depth part.
  /// A crease of this depth (m) and so many standard deviations of the noise parts.
  float crease = 0.015f;
  float crease_gate = 1.5f;
  float belief = 0.1f;  ///< Pixels believed to move by more than this can be part of a thing ...
  float seed_belief = 0.4f;  ///< ... that has at least one pixel believed by more than this.
  /// A thing moves when so many of its pixels were not there a tenth of a second ago ...
  float min_fresh = 0.06f;
  /// ... or so many, if it moved in the frame before, since what drifts would flicker ...
  float min_fresh_on = 0.02f;
  double fresh_age = 0.2;  ///< ... by frames of at most this age (s).
  /// What a box holds is of the room only when it was there so long ago (s), too: people who have
  /// just come into view, or just start to walk, are not.
  double proof_age = 0.35;
  float box_depth = 0.3f;  ///< A box names what is within this (m) of the depth of its middle.
};

/// Which frames are compared with, and when memory ends.
struct HistoryModel {
  double max_step = 0.5;  ///< A camera that moves by more from frame to frame has jumped (m), ...
  double max_turn = 0.5;  ///< ... or that turns by more (rad).
  /// When fewer surfaces are where the motion puts them, the motion is wrong (share of those that
  /// could be; in a crowd of walking people it is 0.95 from frame to frame at 30 Hz, 0.75 at 10
  /// Hz).
  float min_agreement = 0.5f;
};

/// All of it.
struct MaskModel {
  MotionMaskOptions options;
  /// Fewer pixels with depth (share of the image) are no depth image.
  float min_depth_share = 0.02f;
  DepthModel depth;
  EvidenceModel evidence;
  SegmentModel segment;
  HistoryModel history;
};

}  // namespace hmcdyn::internal

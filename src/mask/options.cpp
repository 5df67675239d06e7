// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <stdexcept>
#include <string>

#include <hmcdyn/motion_mask.hpp>

namespace hmcdyn {
namespace {

void requireMaskOption(bool good, const char* name, double value, const char* expected) {
  if (!good) {
    throw std::invalid_argument(std::string("MotionMaskOptions::") + name + " is " +
                                std::to_string(value) + "; expected " + expected);
  }
}

bool isShare(double value) { return value >= 0.0 && value <= 1.0; }
bool isPositive(double value) { return value > 0.0 && std::isfinite(value); }
bool isNotNegative(double value) { return value >= 0.0 && std::isfinite(value); }

void checkDepth(const MaskDepthOptions& o) {
  requireMaskOption(isPositive(o.max_depth), "depth.max_depth", o.max_depth, "above 0 (m)");
  checkModel(o.error);
  requireMaskOption(isPositive(o.gate), "depth.gate", o.gate, "above 0");
  requireMaskOption(isNotNegative(o.slack), "depth.slack", o.slack, "0 or more (m)");
  requireMaskOption(isNotNegative(o.gray_tolerance), "depth.gray_tolerance", o.gray_tolerance,
                    "0 or more gray levels");
}

void checkEvidence(const MaskEvidenceOptions& o) {
  requireMaskOption(isPositive(o.free_weight), "evidence.free_weight", o.free_weight, "above 0");
  requireMaskOption(isNotNegative(o.departure_weight), "evidence.departure_weight",
                    o.departure_weight, "0 or more");
  requireMaskOption(isNotNegative(o.mismatch_weight), "evidence.mismatch_weight", o.mismatch_weight,
                    "0 or more");
  requireMaskOption(isNotNegative(o.named_mismatch_weight), "evidence.named_mismatch_weight",
                    o.named_mismatch_weight, "0 or more");
  requireMaskOption(isShare(o.same_weight_young), "evidence.same_weight_young", o.same_weight_young,
                    "0..1");
  requireMaskOption(isPositive(o.same_age), "evidence.same_age", o.same_age, "above 0 (s)");
  requireMaskOption(isShare(o.drift), "evidence.drift", o.drift, "0..1");
  requireMaskOption(isShare(o.named_drift), "evidence.named_drift", o.named_drift, "0..1");
  requireMaskOption(isNotNegative(o.dynamic_point_weight), "evidence.dynamic_point_weight",
                    o.dynamic_point_weight, "0 or more");
}

void checkSegment(const MaskSegmentOptions& o) {
  requireMaskOption(isPositive(o.reach), "segment.reach", o.reach, "above 0 (reduced px)");
  requireMaskOption(isPositive(o.depth_step), "segment.depth_step", o.depth_step, "above 0");
  requireMaskOption(o.belief >= 0.0f && o.belief < 1.0f, "segment.belief", o.belief,
                    "0 or more, below 1");
  requireMaskOption(o.seed_belief >= o.belief && o.seed_belief < 1.0f, "segment.seed_belief",
                    o.seed_belief, "at least belief, below 1");
  requireMaskOption(isShare(o.min_area), "segment.min_area", o.min_area, "0..1");
  requireMaskOption(isShare(o.min_fresh), "segment.min_fresh", o.min_fresh, "0..1");
  requireMaskOption(isShare(o.min_fresh_on) && o.min_fresh_on <= o.min_fresh,
                    "segment.min_fresh_on", o.min_fresh_on, "0..min_fresh");
  requireMaskOption(isPositive(o.fresh_age), "segment.fresh_age", o.fresh_age, "above 0 (s)");
  requireMaskOption(isPositive(o.box_depth), "segment.box_depth", o.box_depth, "above 0 (m)");
}

void checkHistory(const MaskHistoryOptions& o) {
  requireMaskOption(isPositive(o.max_age) && o.max_age <= 60.0, "history.max_age", o.max_age,
                    "above 0, at most 60 (s)");
  requireMaskOption(isPositive(o.max_gap), "history.max_gap", o.max_gap, "above 0 (s)");
  requireMaskOption(isPositive(o.max_step), "history.max_step", o.max_step, "above 0 (m)");
  requireMaskOption(isPositive(o.max_turn), "history.max_turn", o.max_turn, "above 0 (rad)");
  requireMaskOption(isShare(o.min_agreement), "history.min_agreement", o.min_agreement, "0..1");
}

}  // namespace

void checkOptions(const MotionMaskOptions& options) {
  requireMaskOption(options.working_width >= 16, "working_width", options.working_width,
                    "16 px or more");
  requireMaskOption(isShare(options.max_moving_share), "max_moving_share", options.max_moving_share,
                    "0..1");
  requireMaskOption(isShare(options.min_depth_share), "min_depth_share", options.min_depth_share,
                    "0..1");
  checkDepth(options.depth);
  checkEvidence(options.evidence);
  checkSegment(options.segment);
  checkHistory(options.history);
}

const char* toString(MaskState state) noexcept {
  switch (state) {
    case MaskState::kGood:
      return "good";
    case MaskState::kFirstFrame:
      return "first frame";
    case MaskState::kTimeJump:
      return "time jump";
    case MaskState::kCameraJump:
      return "camera jump";
    case MaskState::kMotionUnknown:
      return "motion unknown";
    case MaskState::kMotionDoubtful:
      return "motion doubtful";
    case MaskState::kNoDepth:
      return "no depth";
    case MaskState::kTooLarge:
      return "too large";
  }
  return "invalid";
}

const char* toString(MaskReason reason) noexcept {
  switch (reason) {
    case MaskReason::kFreeSpace:
      return "free space";
    case MaskReason::kGray:
      return "gray";
    case MaskReason::kMemory:
      return "memory";
    case MaskReason::kNamed:
      return "named";
  }
  return "invalid";
}

}  // namespace hmcdyn

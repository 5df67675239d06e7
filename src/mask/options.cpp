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

}  // namespace

void checkOptions(const MotionMaskOptions& options) {
  requireMaskOption(options.working_width >= 16, "working_width", options.working_width,
                    "16 px or more");
  requireMaskOption(isPositive(options.max_depth), "max_depth", options.max_depth, "above 0 (m)");
  checkModel(options.depth_error);
  requireMaskOption(isNotNegative(options.gray_tolerance), "gray_tolerance", options.gray_tolerance,
                    "0 or more gray levels");
  requireMaskOption(isShare(options.min_area), "min_area", options.min_area, "0..1");
  requireMaskOption(isShare(options.max_moving_share), "max_moving_share", options.max_moving_share,
                    "0..1");
  requireMaskOption(isPositive(options.max_age) && options.max_age <= 60.0, "max_age",
                    options.max_age, "above 0, at most 60 (s)");
  requireMaskOption(isPositive(options.max_gap), "max_gap", options.max_gap, "above 0 (s)");
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

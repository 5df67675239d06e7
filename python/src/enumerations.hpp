// SPDX-License-Identifier: BSD-3-Clause
// Enumerations as Python's own IntEnum: they compare with the numbers in arrays, and are taken by
// name as well.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <pybind11/pybind11.h>

#include <hmcdyn/frame_filter.hpp>
#include <hmcdyn/motion_mask.hpp>
#include <hmcdyn/pose_refinement.hpp>

#include "evaluate/alignment.hpp"
#include "evaluate/relative_pose_error.hpp"

namespace hmcdyn::python {

/// What Python has to know of an enumeration: NAME in Python, and its values by name.
template <class E>
struct EnumerationNames;

// NOLINTNEXTLINE(cppcoreguidelines-macro-usage): it makes a type's name a text
#define HMCDYN_ENUMERATION(Type, ...)                                  \
  template <>                                                          \
  struct EnumerationNames<Type> {                                      \
    static constexpr const char* kType = #Type;                        \
    static constexpr auto kName = pybind11::detail::const_name(#Type); \
    static std::vector<std::pair<const char*, Type>> values() {        \
      using E = Type;                                                  \
      return {__VA_ARGS__};                                            \
    }                                                                  \
  }

using evaluate::AlignmentModel;
using evaluate::DeltaUnit;

HMCDYN_ENUMERATION(KnownMotion, {"AT_REST", E::kAtRest}, {"UNKNOWN", E::kUnknown},
                   {"MOVING", E::kMoving});
HMCDYN_ENUMERATION(PointLabel, {"STATIC", E::kStatic}, {"SUSPECT", E::kSuspect},
                   {"DYNAMIC", E::kDynamic}, {"UNMATCHED", E::kUnmatched});
HMCDYN_ENUMERATION(TwoViewModelKind, {"NONE", E::kNone}, {"FUNDAMENTAL", E::kFundamental},
                   {"HOMOGRAPHY", E::kHomography}, {"IDENTITY", E::kIdentity});
HMCDYN_ENUMERATION(ClusterVerdict, {"STATIC", E::kStatic}, {"STRONGEST", E::kStrongest},
                   {"SCREENED", E::kScreened}, {"DEPTH_NEIGHBOUR", E::kDepthNeighbour});
HMCDYN_ENUMERATION(FilterRule, {"NONE", E::kNone}, {"BOX", E::kBox},
                   {"DYNAMIC_BOX", E::kDynamicBox}, {"EPIPOLAR", E::kEpipolar},
                   {"TWO_THRESHOLD", E::kTwoThreshold}, {"CHI_SQUARE", E::kChiSquare},
                   {"DEPTH_RANSAC", E::kDepthRansac}, {"HMC", E::kHmc});
HMCDYN_ENUMERATION(SurfaceSupport, {"MEASURED", E::kMeasured}, {"ENCLOSED", E::kEnclosed},
                   {"BEHIND", E::kBehind}, {"BESIDE", E::kBeside}, {"NONE", E::kNone});
HMCDYN_ENUMERATION(FundamentalVerdict, {"DEFINED", E::kDefined},
                   {"TOO_FEW_MATCHES", E::kTooFewMatches}, {"CAMERA_STILL", E::kCameraStill},
                   {"ILL_CONDITIONED", E::kIllConditioned}, {"NO_CONSENSUS", E::kNoConsensus});
HMCDYN_ENUMERATION(MatchSource, {"ALL", E::kAll}, {"BACKGROUND", E::kBackground},
                   {"AT_REST", E::kAtRest}, {"NOT_MOVING", E::kNotMoving},
                   {"PREDICTION", E::kPrediction});
HMCDYN_ENUMERATION(DistanceKind, {"TWO_VIEW", E::kTwoView}, {"EGO_MOTION", E::kEgoMotion},
                   {"LARGER", E::kLarger});
HMCDYN_ENUMERATION(Ablation, {"NONE", E::kNone}, {"RS", E::kRs}, {"DF", E::kDf}, {"OPW", E::kOpw});
HMCDYN_ENUMERATION(FrameFilterStatus, {"FILTERED", E::kFiltered},
                   {"NOTHING_TO_DO", E::kNothingToDo}, {"NO_HISTORY", E::kNoHistory},
                   {"CAMERA_UNKNOWN", E::kCameraUnknown}, {"STAMP_NOT_RISING", E::kStampNotRising});
HMCDYN_ENUMERATION(PointReason, {"OUTSIDE", E::kOutside}, {"AT_REST", E::kAtRest},
                   {"APART", E::kApart}, {"MOVES", E::kMoves}, {"MOVES_ALONG", E::kMovesAlong},
                   {"ROOM", E::kRoom}, {"MASK", E::kMask}, {"NO_HISTORY", E::kNoHistory},
                   {"FOR_NUMBER", E::kForNumber});
HMCDYN_ENUMERATION(MaskLabel, {"STATIC", E::kStatic}, {"UNKNOWN", E::kUnknown},
                   {"STANDING", E::kStanding}, {"MOVING", E::kMoving});
HMCDYN_ENUMERATION(MaskState, {"GOOD", E::kGood}, {"FIRST_FRAME", E::kFirstFrame},
                   {"TIME_JUMP", E::kTimeJump}, {"CAMERA_JUMP", E::kCameraJump},
                   {"MOTION_UNKNOWN", E::kMotionUnknown}, {"MOTION_DOUBTFUL", E::kMotionDoubtful},
                   {"NO_DEPTH", E::kNoDepth}, {"TOO_LARGE", E::kTooLarge});
HMCDYN_ENUMERATION(MaskReason, {"FREE_SPACE", E::kFreeSpace}, {"GRAY", E::kGray},
                   {"MEMORY", E::kMemory}, {"NAMED", E::kNamed});
HMCDYN_ENUMERATION(DepthRow, {"NONE", E::kNone}, {"DEPTH", E::kDepth},
                   {"DISPARITY", E::kDisparity});
HMCDYN_ENUMERATION(RobustLoss, {"NONE", E::kNone}, {"HUBER", E::kHuber});
HMCDYN_ENUMERATION(WeightMode, {"FIXED", E::kFixed}, {"JOINT", E::kJoint});
HMCDYN_ENUMERATION(PoseSolver, {"COLLAPSED", E::kCollapsed}, {"CERES_PROBLEM", E::kCeresProblem});
HMCDYN_ENUMERATION(PoseRefinementTermination, {"CONVERGED", E::kConverged},
                   {"ITERATION_LIMIT", E::kIterationLimit}, {"TOO_FEW_POINTS", E::kTooFewPoints},
                   {"TOO_FEW_INLIERS", E::kTooFewInliers},
                   {"NUMERICAL_FAILURE", E::kNumericalFailure});
HMCDYN_ENUMERATION(AlignmentModel, {"RIGID", E::kRigid}, {"SIMILARITY", E::kSimilarity});
HMCDYN_ENUMERATION(DeltaUnit, {"SECONDS", E::kSeconds}, {"METRES", E::kMetres},
                   {"RADIANS", E::kRadians}, {"DEGREES", E::kDegrees}, {"FRAMES", E::kFrames});

#undef HMCDYN_ENUMERATION

/// Makes all of them in the module.
void bindEnumerations(pybind11::module_& module);

/// The value of the Python enumeration with this number. @param type its name.
pybind11::object enumerationValue(const char* type, int value);

}  // namespace hmcdyn::python

namespace pybind11::detail {

/// Any enumeration that Python was told of.
template <class E>
class type_caster<E, std::void_t<decltype(hmcdyn::python::EnumerationNames<E>::kType)>> {
  using Names = hmcdyn::python::EnumerationNames<E>;

 public:
  PYBIND11_TYPE_CASTER(E, Names::kName);

  /// From a value of the enumeration, or its name in either case: FilterRule.HMC or "hmc".
  bool load(handle source, bool /*convert*/) {
    const bool is_name = isinstance<str>(source);
    if (!is_name && !PyLong_Check(source.ptr())) {
      return false;
    }
    const std::string asked =
        is_name ? source.attr("upper")().template cast<std::string>() : std::string();
    std::string expected;
    for (const auto& [known, number] : Names::values()) {
      if (is_name ? asked == known : PyLong_AsLong(source.ptr()) == static_cast<long>(number)) {
        value = number;
        return true;
      }
      expected += (expected.empty() ? "" : ", ") + std::string(known);
    }
    throw std::invalid_argument(std::string(Names::kType) + " is " +
                                str(source).template cast<std::string>() + "; expected one of " +
                                expected);
  }

  static handle cast(E source, return_value_policy /*policy*/, handle /*parent*/) {
    return hmcdyn::python::enumerationValue(Names::kType, static_cast<int>(source)).release();
  }
};

}  // namespace pybind11::detail

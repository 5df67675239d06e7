// SPDX-License-Identifier: BSD-3-Clause
#include "enumerations.hpp"

#include "comments.hpp"

namespace hmcdyn::python {
namespace {

/// The types by name. The interpreter's for good: while the module is being made it cannot be
/// imported, and at the interpreter's end nothing of it may be given back any more.
pybind11::dict& types() {
  static auto* const known = new pybind11::dict();  // NOLINT(cppcoreguidelines-owning-memory)
  return *known;
}

template <class E>
void bindEnumeration(pybind11::module_& module) {
  using Names = EnumerationNames<E>;
  pybind11::dict values;
  for (const auto& [name, value] : Names::values()) {
    values[name] = static_cast<int>(value);
  }
  const pybind11::object type = pybind11::module_::import("enum").attr("IntEnum")(
      Names::kType, values, pybind11::arg("module") = "hmcdyn");
  type.attr("__doc__") = commentOf(Names::kType);
  types()[Names::kType] = type;
  module.attr(Names::kType) = type;
}

template <class... E>
void bindAll(pybind11::module_& module) {
  (bindEnumeration<E>(module), ...);
}

}  // namespace

void bindEnumerations(pybind11::module_& module) {
  bindAll<KnownMotion, PointLabel, TwoViewModelKind, ClusterVerdict, FilterRule, SurfaceSupport,
          FundamentalVerdict, MatchSource, DistanceKind, Ablation, FrameFilterStatus, PointReason,
          MaskLabel, MaskState, MaskReason, DepthRow, RobustLoss, WeightMode, PoseSolver,
          PoseRefinementTermination, AlignmentModel, DeltaUnit>(module);
}

pybind11::object enumerationValue(const char* type, int value) { return types()[type](value); }

}  // namespace hmcdyn::python

// SPDX-License-Identifier: BSD-3-Clause
// filter_stage.hpp, and the options of peer_rules.hpp
#include <hmcdyn/filter_stage.hpp>
#include <hmcdyn/peers/peer_rules.hpp>

#include "bindings.hpp"
#include "key_points.hpp"
#include "structs.hpp"

namespace hmcdyn::python {

void bindFilterStage(py::module_& module) {
  HMCDYN_BIND_OPTIONS(module, TwoThresholdOptions);
  HMCDYN_BIND_OPTIONS(module, ChiSquareOptions);
  HMCDYN_BIND_OPTIONS(module, DepthRansacOptions);
  HMCDYN_BIND_OPTIONS(module, FilterStageOptions);
  HMCDYN_BIND_RESULT(module, BoxDecision);
  HMCDYN_BIND_RESULT(module, FrameDecision);
  HMCDYN_BIND_RESULT(module, FilterStageResult);
  module.def(
      "filter_key_points",
      [](const ArrayLike& u, const ArrayLike& v, const ArrayLike& depth, const ArrayLike& distance,
         const BoxesLike& boxes, const BoxMembership* membership,
         const OptionsOf<FilterStageOptions>& options, const py::kwargs& fields) {
        const KeyPointColumns points(u, v, depth);
        const auto distances = column<float>(distance, "distance");
        const std::vector<DetectionBox> own = boxesOf(boxes);
        const auto set = optionsFrom<FilterStageOptions>(options, fields);
        return unlocked([&] {
          if (membership == nullptr) {
            return filterKeyPoints(points.view(), distances.values, own, set);
          }
          FilterStageWorkspace workspace;
          filterKeyPoints(points.view(), distances.values, own, *membership, set, workspace);
          return std::move(workspace.result);
        });
      },
      py::arg("u"), py::arg("v"), py::arg("depth"), py::arg("distance"), py::arg("boxes"),
      py::arg("membership") = nullptr, py::arg("options") = py::none(),
      commentOf("filterKeyPoints"));
}

}  // namespace hmcdyn::python

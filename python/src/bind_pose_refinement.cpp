// SPDX-License-Identifier: BSD-3-Clause
// pose_refinement.hpp
#include <hmcdyn/pose_refinement.hpp>

#include "bindings.hpp"
#include "structs.hpp"

namespace hmcdyn::python {

void bindPoseRefinement(py::module_& module) {
  HMCDYN_BIND_OPTIONS(module, PoseRefinementOptions);
  {
    py::class_<PoseRefinementResult> type(module, "PoseRefinementResult",
                                          commentOf("PoseRefinementResult"));
    HMCDYN_FIELDS_PoseRefinementResult(HMCDYN_READ_ONLY);
    type.def_property_readonly("succeeded", &PoseRefinementResult::succeeded,
                               commentOf("PoseRefinementResult::succeeded"));
    type.def("__repr__", [](const py::object& self) { return textOf(self); });
  }
  module.def(
      "refine_pose",
      [](const ArrayLike& x, const ArrayLike& y, const ArrayLike& z, const ArrayLike& u,
         const ArrayLike& v, const PinholeCamera& camera, const ArrayLike& initial,
         const ArrayLike& sigma, const ArrayLike& depth, const ArrayLike& weight,
         const ArrayLike& depth_sigma, const OptionsOf<PoseRefinementOptions>& options,
         const py::kwargs& fields) {
        const auto xs = column<float>(x, "x");
        const auto ys = column<float>(y, "y");
        const auto zs = column<float>(z, "z");
        const auto us = column<float>(u, "u");
        const auto vs = column<float>(v, "v");
        const auto sigmas = column<float>(sigma, "sigma");
        const auto depths = column<float>(depth, "depth");
        const auto weights = column<float>(weight, "weight");
        const auto depth_sigmas = column<float>(depth_sigma, "depth_sigma");
        const Pose start(motionOf(initial, "initial"));
        const auto own = optionsFrom<PoseRefinementOptions>(options, fields);
        return unlocked([&] {
          return refinePose({xs.values, ys.values, zs.values, us.values, vs.values, sigmas.values,
                             depths.values, weights.values, depth_sigmas.values},
                            camera, start, own);
        });
      },
      py::arg("x"), py::arg("y"), py::arg("z"), py::arg("u"), py::arg("v"), py::arg("camera"),
      py::arg("initial"), py::arg("sigma") = py::none(), py::arg("depth") = py::none(),
      py::arg("weight") = py::none(), py::arg("depth_sigma") = py::none(),
      py::arg("options") = py::none(), commentOf("refinePose"));
}

}  // namespace hmcdyn::python

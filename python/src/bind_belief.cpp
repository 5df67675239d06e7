// SPDX-License-Identifier: BSD-3-Clause
// surface_depth.hpp, motion_belief.hpp, belief_verdict.hpp, depth_error.hpp
#include <hmcdyn/depth_error.hpp>
#include <hmcdyn/votes/belief_verdict.hpp>
#include <hmcdyn/votes/motion_belief.hpp>
#include <hmcdyn/votes/surface_depth.hpp>

#include "bindings.hpp"
#include "key_points.hpp"
#include "structs.hpp"

namespace hmcdyn::python {
namespace {

DepthImageView viewOfDepth(const cv::Mat& depth) {
  return {depth.ptr<float>(), depth.cols, depth.rows, depth.step1()};
}

}  // namespace

void bindBelief(py::module_& module) {
  HMCDYN_BIND_OPTIONS(module, DepthErrorModel);
  HMCDYN_BIND_OPTIONS(module, SurfaceDepthOptions);
  HMCDYN_BIND_RESULT(module, SurfaceDepths);
  module.def(
      "surface_depths",
      [](const ArrayLike& image, const ArrayLike& u, const ArrayLike& v,
         const OptionsOf<SurfaceDepthOptions>& options, const py::kwargs& fields) {
        const Image depth = depthImage(image, "image");
        const auto columns = column<float>(u, "u");
        const auto rows = column<float>(v, "v");
        const auto own = optionsFrom<SurfaceDepthOptions>(options, fields);
        return unlocked([&] {
          const DepthImageView view = depth.mat.empty() ? DepthImageView{} : viewOfDepth(depth.mat);
          return surfaceDepths(view, columns.values, rows.values, own);
        });
      },
      py::arg("image"), py::arg("u"), py::arg("v"), py::arg("options") = py::none(),
      commentOf("surfaceDepths"));

  HMCDYN_BIND_OPTIONS(module, MotionBeliefOptions);
  HMCDYN_BIND_OPTIONS(module, BeliefVerdictOptions);
  {
    py::class_<MotionBelief> type(module, "MotionBelief", commentOf("MotionBelief"));
    type.def(py::init());
    HMCDYN_FIELDS_MotionBelief(HMCDYN_READ_ONLY);
    type.def("__len__", &MotionBelief::size);
  }
  module.def(
      "update_motion_belief",
      [](const ArrayLike& u, const ArrayLike& v, const ArrayLike& depth, const ArrayLike& distance,
         const ArrayLike& label, const ArrayLike& in_box, const SurfaceDepths& surface,
         const MotionBelief& memory, const ArrayLike& earlier_u, const ArrayLike& earlier_v,
         const OptionsOf<MotionBeliefOptions>& options, const py::kwargs& fields) {
        const KeyPointColumns points(u, v, depth);
        const auto distances = column<float>(distance, "distance");
        const auto labels = column<std::uint8_t>(label, "label");
        const auto flags = column<std::uint8_t>(in_box, "in_box");
        const auto columns = column<float>(earlier_u, "earlier_u");
        const auto rows = column<float>(earlier_v, "earlier_v");
        const auto own = optionsFrom<MotionBeliefOptions>(options, fields);
        return unlocked([&] {
          std::vector<PointLabel> verdicts;
          for (const std::uint8_t number : labels.values) {
            verdicts.push_back(static_cast<PointLabel>(number));
          }
          MotionBeliefWorkspace workspace;
          workspace.surface = surface;
          return updateMotionBelief({points.view(), distances.values, verdicts, flags.values,
                                     columns.values, rows.values},
                                    memory, own, workspace);
        });
      },
      py::arg("u"), py::arg("v"), py::arg("depth"), py::arg("distance"), py::arg("label"),
      py::arg("in_box"), py::arg("surface"), py::arg("memory"), py::arg("earlier_u") = py::none(),
      py::arg("earlier_v") = py::none(), py::arg("options") = py::none(),
      commentOf("updateMotionBelief"));
  module.def(
      "apply_motion_belief",
      [](const MotionBelief& belief, const ArrayLike& is_dragged, const FilterStageResult& stage,
         const OptionsOf<MotionBeliefOptions>& options,
         const OptionsOf<BeliefVerdictOptions>& verdict) {
        const auto flags = column<std::uint8_t>(is_dragged, "is_dragged");
        const auto own = optionsFrom<MotionBeliefOptions>(options, {});
        const auto last = optionsFrom<BeliefVerdictOptions>(verdict, {});
        return unlocked([&] { return applyMotionBelief(belief, flags.values, stage, own, last); });
      },
      py::arg("belief"), py::arg("is_dragged"), py::arg("stage"), py::arg("options") = py::none(),
      py::arg("verdict") = py::none(), commentOf("applyMotionBelief"));
}

}  // namespace hmcdyn::python

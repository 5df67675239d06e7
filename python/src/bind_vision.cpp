// SPDX-License-Identifier: BSD-3-Clause
// optical_flow.hpp, fundamental.hpp, dynamic_feature_filter.hpp
#include <hmcdyn/dynamic_feature_filter.hpp>
#include <hmcdyn/label_image.hpp>
#include <hmcdyn/steps/fundamental.hpp>
#include <hmcdyn/steps/optical_flow.hpp>

#include "bindings.hpp"
#include "key_points.hpp"
#include "structs.hpp"

namespace hmcdyn::python {
namespace {

void bindFlow(py::module_& module) {
  HMCDYN_BIND_OPTIONS(module, OpticalFlowOptions);
  HMCDYN_BIND_RESULT(module, FlowMatches);
  module.def(
      "track_into_earlier_frame",
      [](const ArrayLike& current_gray, const ArrayLike& earlier_gray, const ArrayLike& u,
         const ArrayLike& v, const OptionsOf<OpticalFlowOptions>& options,
         const py::kwargs& fields) {
        const Image current = grayImage(current_gray, "current_gray");
        const Image earlier = grayImage(earlier_gray, "earlier_gray");
        const KeyPointColumns points(u, v, u);  // depths have no part in it
        const auto own = optionsFrom<OpticalFlowOptions>(options, fields);
        return unlocked([&] {
          return trackIntoEarlierFrame(buildFlowPyramid(current.mat, own),
                                       buildFlowPyramid(earlier.mat, own), points.view(), own);
        });
      },
      py::arg("current_gray"), py::arg("earlier_gray"), py::arg("u"), py::arg("v"),
      py::arg("options") = py::none(), commentOf("trackIntoEarlierFrame"));
}

void bindTwoViewModel(py::module_& module) {
  HMCDYN_BIND_OPTIONS(module, TwoViewOptions);
  HMCDYN_BIND_RESULT(module, TwoViewEstimate);
  module.def(
      "estimate_two_view_model",
      [](const ArrayLike& earlier_u, const ArrayLike& earlier_v, const ArrayLike& current_u,
         const ArrayLike& current_v, const BoxesLike& boxes,
         const OptionsOf<TwoViewOptions>& options, const py::kwargs& fields) {
        const PairColumns pairs(earlier_u, earlier_v, current_u, current_v);
        const std::vector<DetectionBox> own = boxesOf(boxes);
        const auto set = optionsFrom<TwoViewOptions>(options, fields);
        return unlocked([&] { return estimateTwoViewModel(pairs.view(), own, set); });
      },
      py::arg("earlier_u"), py::arg("earlier_v"), py::arg("current_u"), py::arg("current_v"),
      py::arg("boxes") = py::none(), py::arg("options") = py::none(),
      commentOf("estimateTwoViewModel"));
}

}  // namespace

void bindVision(py::module_& module) {
  bindFlow(module);
  bindTwoViewModel(module);
  HMCDYN_BIND_OPTIONS(module, DynamicFeatureFilterOptions);
  HMCDYN_BIND_RESULT(module, EarlierFrameReport);
  HMCDYN_BIND_RESULT(module, DynamicFeatureFilterResult);
  module.def(
      "filter_dynamic_features",
      [](const ArrayLike& earlier_gray, const ArrayLike& current_gray, const ArrayLike& u,
         const ArrayLike& v, const ArrayLike& depth, const BoxesLike& boxes,
         const ArrayLike& labels, const RegionsLike& regions,
         const OptionsOf<DynamicFeatureFilterOptions>& options, const py::kwargs& fields) {
        const Image earlier = grayImage(earlier_gray, "earlier_gray");
        const Image current = grayImage(current_gray, "current_gray");
        const KeyPointColumns points(u, v, depth);
        const Image mask = labelImage(labels, "labels");
        if (!mask.mat.empty() && !boxes.is_none()) {
          throw std::invalid_argument("boxes and labels are given; expected one of them");
        }
        const std::vector<DetectionBox> own = boxesOf(boxes);
        const bool all_regions = regions.is_none();
        const std::vector<LabelRegion> named = regionsOf(regions);
        const auto set = optionsFrom<DynamicFeatureFilterOptions>(options, fields);
        return unlocked([&] {
          if (mask.mat.empty()) {
            return filterDynamicFeatures(earlier.mat, current.mat, points.view(), own, set);
          }
          return filterDynamicFeatures(earlier.mat, current.mat, points.view(), mask.mat,
                                       all_regions ? regionsIn(mask.mat) : named, set);
        });
      },
      py::arg("earlier_gray"), py::arg("current_gray"), py::arg("u"), py::arg("v"),
      py::arg("depth"), py::arg("boxes") = py::none(), py::arg("labels") = py::none(),
      py::arg("regions") = py::none(), py::arg("options") = py::none(),
      "Two gray images, key points and boxes or labels: which points move.\n\n"
      "earlier_gray, current_gray: uint8, (H, W). u, v (px) and depth (m; 0 or NaN = none): N "
      "each.\nboxes: DetectionBoxes or rows x_min, y_min, x_max, y_max, score, class. "
      "labels: in place of boxes, an image of regions (0 = background); regions says which may "
      "move, all where it is not given.\noptions: DynamicFeatureFilterOptions, or its fields by "
      "name.\n\nValueError for images that are not gray or not of one size, or unequal arrays.");
}

}  // namespace hmcdyn::python

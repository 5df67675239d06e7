// SPDX-License-Identifier: BSD-3-Clause
// box_dynamism.hpp, regions.hpp, label_image.hpp
#include <hmcdyn/frame_filter.hpp>
#include <hmcdyn/label_image.hpp>
#include <hmcdyn/regions.hpp>
#include <hmcdyn/steps/box_dynamism.hpp>

#include "bindings.hpp"
#include "key_points.hpp"
#include "structs.hpp"

namespace hmcdyn::python {
namespace {

void bindRegions(py::module_& module) {
  module.def(
      "regions_in",
      [](const ArrayLike& labels, int background, int class_id) {
        const Image image = labelImage(labels, "labels");
        return unlocked([&] { return regionsIn(image.mat, background, class_id); });
      },
      py::arg("labels"), py::arg("background") = 0, py::arg("class_id") = kPersonClassId,
      commentOf("regionsIn"));
  module.def(
      "regions_of_points",
      [](const ArrayLike& u, const ArrayLike& v, const ArrayLike& depth, const ArrayLike& labels,
         const RegionsLike& regions) {
        const KeyPointColumns points(u, v, depth);
        const Image image = labelImage(labels, "labels");
        const std::vector<LabelRegion> own = regionsOf(regions);
        return toNumpy(unlocked([&] { return regionsOfPoints(points.view(), image.mat, own); }));
      },
      py::arg("u"), py::arg("v"), py::arg("depth"), py::arg("labels"), py::arg("regions"),
      commentOf("regionsOfPoints"));
  module.def(
      "assign_to_regions",
      [](const ArrayLike& region, std::size_t regions) {
        const auto own = column<int>(region, "region");
        return unlocked([&] { return assignToRegions(own.values, regions); });
      },
      py::arg("region"), py::arg("regions"), commentOf("assignToRegions"));
  module.def(
      "bounding_boxes",
      [](const ArrayLike& labels, const RegionsLike& regions) {
        const Image image = labelImage(labels, "labels");
        const std::vector<LabelRegion> own = regionsOf(regions);
        return unlocked([&] { return boundingBoxes(image.mat, own); });
      },
      py::arg("labels"), py::arg("regions"), commentOf("boundingBoxes"));
}

}  // namespace

void bindBoxes(py::module_& module) {
  HMCDYN_BIND_OPTIONS(module, BoxDynamismOptions);
  HMCDYN_BIND_RESULT(module, BoxMembership);
  HMCDYN_BIND_RESULT(module, BoxVerdict);
  HMCDYN_BIND_RESULT(module, BoxDynamism);
  module.def(
      "assign_to_boxes",
      [](const ArrayLike& u, const ArrayLike& v, const ArrayLike& depth, const BoxesLike& boxes) {
        const KeyPointColumns points(u, v, depth);
        const std::vector<DetectionBox> own = boxesOf(boxes);
        return unlocked([&] { return assignToBoxes(points.view(), own); });
      },
      py::arg("u"), py::arg("v"), py::arg("depth"), py::arg("boxes"), commentOf("assignToBoxes"));
  module.def(
      "test_boxes",
      [](const ArrayLike& distance, const BoxesLike& boxes, const BoxMembership& membership,
         const OptionsOf<BoxDynamismOptions>& options, const py::kwargs& fields) {
        const auto distances = column<float>(distance, "distance");
        const std::vector<DetectionBox> own = boxesOf(boxes);
        const auto set = optionsFrom<BoxDynamismOptions>(options, fields);
        return unlocked([&] { return testBoxes(distances.values, own, membership, set); });
      },
      py::arg("distance"), py::arg("boxes"), py::arg("membership"), py::arg("options") = py::none(),
      commentOf("testBoxes"));
  module.def(
      "covered_share",
      [](const BoxesLike& boxes, int width, int height) {
        return coveredShare(boxesOf(boxes), {width, height});
      },
      py::arg("boxes"), py::arg("width"), py::arg("height"), commentOf("coveredShare"));
  module.def(
      "feature_factor",
      [](const BoxesLike& boxes, int width, int height, double max_factor) {
        return featureFactor(boxesOf(boxes), {width, height}, max_factor);
      },
      py::arg("boxes"), py::arg("width"), py::arg("height"), py::arg("max_factor") = 2.5,
      commentOf("featureFactor"));
  bindRegions(module);
}

}  // namespace hmcdyn::python

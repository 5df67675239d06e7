// SPDX-License-Identifier: BSD-3-Clause
// types.hpp, regions.hpp's LabelRegion
#include <hmcdyn/regions.hpp>
#include <hmcdyn/types.hpp>

#include "bindings.hpp"
#include "structs.hpp"

namespace hmcdyn::python {

void bindTypes(py::module_& module) {
  {
    py::class_<DetectionBox> type(module, "DetectionBox", commentOf("DetectionBox"));
    type.def(
        py::init([](float x_min, float y_min, float x_max, float y_max, int class_id, float score) {
          return DetectionBox{x_min, y_min, x_max, y_max, class_id, score};
        }),
        py::arg("x_min"), py::arg("y_min"), py::arg("x_max"), py::arg("y_max"),
        py::arg("class_id") = kPersonClassId, py::arg("score") = 1.0f);
    HMCDYN_FIELDS_DetectionBox(HMCDYN_OPTION);
    type.def("contains", &DetectionBox::contains, py::arg("u"), py::arg("v"),
             commentOf("DetectionBox::contains"));
    type.def("__repr__", [](const py::object& self) { return textOf(self); });
  }
  {
    py::class_<PinholeCamera> type(module, "PinholeCamera", commentOf("PinholeCamera"));
    type.def(py::init([](double fx, double fy, double cx, double cy) {
               return PinholeCamera{fx, fy, cx, cy};
             }),
             py::arg("fx"), py::arg("fy"), py::arg("cx"), py::arg("cy"));
    HMCDYN_FIELDS_PinholeCamera(HMCDYN_OPTION);
    type.def("__repr__", [](const py::object& self) { return textOf(self); });
  }
  {
    py::class_<LabelRegion> type(module, "LabelRegion", commentOf("LabelRegion"));
    type.def(py::init([](int label, int class_id, float score) {
               return LabelRegion{label, class_id, score};
             }),
             py::arg("label"), py::arg("class_id") = kPersonClassId, py::arg("score") = 1.0f);
    HMCDYN_FIELDS_LabelRegion(HMCDYN_OPTION);
    type.def("__repr__", [](const py::object& self) { return textOf(self); });
  }
  module.attr("PERSON_CLASS_ID") = kPersonClassId;
}

}  // namespace hmcdyn::python

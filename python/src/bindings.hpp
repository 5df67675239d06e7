// SPDX-License-Identifier: BSD-3-Clause
// The parts of the module, one a header or two, in the order in which a frame's data flows: a type
// is bound before what mentions it.
#pragma once

#include <pybind11/pybind11.h>

namespace hmcdyn::python {

void bindTypes(pybind11::module_& module);
void bindEpipolar(pybind11::module_& module);
void bindBoxes(pybind11::module_& module);
void bindClusters(pybind11::module_& module);
void bindFilterStage(pybind11::module_& module);
void bindBelief(pybind11::module_& module);
void bindVision(pybind11::module_& module);
void bindMotionMask(pybind11::module_& module);
void bindFrameFilter(pybind11::module_& module);
void bindPoseRefinement(pybind11::module_& module);
void bindEvaluation(pybind11::module_& module);

}  // namespace hmcdyn::python

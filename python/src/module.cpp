// SPDX-License-Identifier: BSD-3-Clause
#include <hmcdyn/version.hpp>

#include "bindings.hpp"
#include "enumerations.hpp"

// NOLINTNEXTLINE(readability-identifier-length): pybind11's
PYBIND11_MODULE(_hmcdyn, module) {
  module.doc() = "Which key points of a frame lie on moving things (the C++ part of hmcdyn).";
  module.attr("__version__") = HMCDYN_VERSION_STRING;
  namespace bindings = hmcdyn::python;
  bindings::bindEnumerations(module);
  bindings::bindTypes(module);
  bindings::bindEpipolar(module);
  bindings::bindBoxes(module);
  bindings::bindClusters(module);
  bindings::bindFilterStage(module);
  bindings::bindBelief(module);
  bindings::bindVision(module);
  bindings::bindMotionMask(module);
  bindings::bindFrameFilter(module);
  bindings::bindPoseRefinement(module);
  bindings::bindEvaluation(module);
}

// SPDX-License-Identifier: BSD-3-Clause
// motion_mask.hpp
#include <hmcdyn/label_image.hpp>
#include <hmcdyn/motion_mask.hpp>

#include "bindings.hpp"
#include "guarded.hpp"
#include "masks.hpp"
#include "structs.hpp"

namespace hmcdyn::python {
namespace {

using SharedEstimator = Guarded<MotionMaskEstimator>;

MotionMask updateMask(SharedEstimator& self, double timestamp, const ArrayLike& depth,
                      const ArrayOrNone& camera_from_world, const ArrayLike& gray,
                      const BoxesLike& boxes, const ArrayLike& labels, const RegionsLike& regions) {
  const Image depth_image = depthImage(depth, "depth");
  const Image gray_image = grayImage(gray, "gray");
  const Image label_image = labelImage(labels, "labels");
  const std::vector<DetectionBox> own_boxes = boxesOf(boxes);
  std::vector<LabelRegion> own_regions = regionsOf(regions);
  if (regions.is_none() && !label_image.mat.empty()) {
    own_regions = regionsIn(label_image.mat);
  }
  MotionMaskFrame frame;
  frame.timestamp = timestamp;
  frame.depth = depth_image.mat;
  frame.gray = gray_image.mat;
  frame.pose_is_known = !camera_from_world.is_none();
  if (frame.pose_is_known) {
    frame.camera_from_world = motionOf(camera_from_world, "camera_from_world");
  }
  frame.regions.boxes = own_boxes;
  frame.regions.labels = label_image.mat;
  frame.regions.labelled = own_regions;
  return self.with([&](MotionMaskEstimator& estimator) { return copyOf(estimator.update(frame)); });
}

}  // namespace

void bindMotionMask(py::module_& module) {
  HMCDYN_BIND_OPTIONS(module, MotionMaskOptions);
  HMCDYN_BIND_RESULT(module, MaskInstance);
  HMCDYN_BIND_RESULT(module, MotionMask);

  py::class_<SharedEstimator> type(module, "MotionMaskEstimator", commentOf("MotionMaskEstimator"));
  type.def(py::init([](const PinholeCamera& camera, const OptionsOf<MotionMaskOptions>& options,
                       const py::kwargs& fields) {
             return std::make_unique<SharedEstimator>(
                 MotionMaskEstimator(camera, optionsFrom<MotionMaskOptions>(options, fields)));
           }),
           py::arg("camera"), py::arg("options") = py::none(),
           commentOf("MotionMaskEstimator::MotionMaskEstimator"));
  type.def("update", &updateMask, py::arg("timestamp"), py::arg("depth"),
           py::arg("camera_from_world"), py::arg("gray") = py::none(),
           py::arg("boxes") = py::none(), py::arg("labels") = py::none(),
           py::arg("regions") = py::none(),
           "The mask of a frame.\n\n"
           "timestamp: (s). depth: float32 (m), (H, W); 0 = none. camera_from_world: (4, 4), takes "
           "points of the world to the camera's frame; any world that does not jump will do. None "
           "= not known, and the frame cannot be compared. "
           "gray: uint8, (H, W). boxes, labels, regions: things that may move, if you know "
           "some.\n\nThe result's images are copies, which the next call leaves alone.\n\n"
           "ValueError for an image of the wrong type, images of unequal size or below 16 px.");
  type.def(
      "set_pose",
      [](SharedEstimator& self, double timestamp, const ArrayLike& camera_from_world) {
        const Pose pose(motionOf(camera_from_world, "camera_from_world"));
        self.with([&](MotionMaskEstimator& estimator) { estimator.setPose(timestamp, pose); });
      },
      py::arg("timestamp"), py::arg("camera_from_world"),
      commentOf("MotionMaskEstimator::setPose"));
  type.def(
      "reset",
      [](SharedEstimator& self) {
        self.with([](MotionMaskEstimator& estimator) { estimator.reset(); });
      },
      commentOf("MotionMaskEstimator::reset"));
  module.def(
      "static_depth",
      [](const ArrayLike& depth, const ArrayLike& label, bool keep_standing) {
        const Image depth_image = depthImage(depth, "depth");
        const Image label_image = labelImage(label, "label");
        return toNumpy(
            unlocked([&] { return staticDepth(depth_image.mat, label_image.mat, keep_standing); }));
      },
      py::arg("depth"), py::arg("label"), py::arg("keep_standing") = false,
      commentOf("staticDepth"));
}

}  // namespace hmcdyn::python

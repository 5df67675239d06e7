// SPDX-License-Identifier: BSD-3-Clause
// frame_filter.hpp
#include <optional>

#include <hmcdyn/frame_filter.hpp>
#include <hmcdyn/label_image.hpp>

#include "bindings.hpp"
#include "guarded.hpp"
#include "masks.hpp"
#include "structs.hpp"

namespace hmcdyn::python {
namespace {

using SharedFilter = Guarded<FrameFilter>;

/// Key points as (N, 2) pixels, or a sequence of OpenCV's KeyPoint.
std::vector<cv::KeyPoint> keyPointsOf(const py::object& argument) {
  std::vector<cv::KeyPoint> points;
  const bool is_array = py::isinstance<py::array>(argument);
  if (!is_array && py::isinstance<py::sequence>(argument) && py::len(argument) > 0 &&
      py::hasattr(argument[py::int_(0)], "pt")) {
    for (const py::handle point : argument) {
      const auto pixel = point.attr("pt").cast<std::pair<float, float>>();
      points.emplace_back(pixel.first, pixel.second, 1.0f);
    }
    return points;
  }
  const std::vector<float> rows = rowsOf(argument, "key_points", 2);
  points.reserve(rows.size() / 2);
  for (std::size_t i = 0; i < rows.size(); i += 2) {
    points.emplace_back(rows[i], rows[i + 1], 1.0f);
  }
  return points;
}

std::vector<cv::Point2f> pixelsOf(const py::object& argument) {
  std::vector<cv::Point2f> pixels;
  if (argument.is_none()) {
    return pixels;
  }
  const std::vector<float> rows = rowsOf(argument, "matched_pixels", 2);
  for (std::size_t i = 0; i < rows.size(); i += 2) {
    pixels.emplace_back(rows[i], rows[i + 1]);
  }
  return pixels;
}

FrameFilterResult filterFrame(SharedFilter& self, double timestamp, const ArrayLike& gray,
                              const ArrayLike& key_points, const BoxesLike& boxes,
                              const ArrayLike& depth, const ArrayLike& point_depth,
                              const ArrayLike& labels, const RegionsLike& regions,
                              const ArrayLike& predicted_pose, double matched_timestamp,
                              const ArrayLike& matched_pixels) {
  // What the frame looks at lives to the end of the call; the filter copies what it remembers.
  const Image gray_image = grayImage(gray, "gray");
  const Image depth_image = depthImage(depth, "depth");
  const Image label_image = labelImage(labels, "labels");
  const std::vector<cv::KeyPoint> points = keyPointsOf(key_points);
  const auto depths = column<float>(point_depth, "point_depth");
  const std::vector<cv::Point2f> matched = pixelsOf(matched_pixels);
  const std::vector<DetectionBox> own_boxes = boxesOf(boxes);
  if (!boxes.is_none() && !labels.is_none()) {
    throw std::invalid_argument("boxes and labels are given; expected one of them");
  }
  std::vector<LabelRegion> own_regions = regionsOf(regions);
  if (regions.is_none() && !label_image.mat.empty()) {
    own_regions = regionsIn(label_image.mat);
  }
  FrameInput frame;
  frame.timestamp = timestamp;
  frame.gray = gray_image.mat;
  frame.depth = depth_image.mat;
  frame.key_points = points;
  frame.point_depth = depths.values;
  frame.matched_timestamp = matched_timestamp;
  frame.matched_pixels = matched;
  if (!predicted_pose.is_none()) {
    frame.predicted_pose = Pose(motionOf(predicted_pose, "predicted_pose"));
  }
  const bool is_silent = boxes.is_none() && labels.is_none();
  return self.with([&](FrameFilter& filter) {
    if (is_silent) {
      return filter.filter(frame);
    }
    return filter.filter(frame, label_image.mat.empty() ? Regions(own_boxes)
                                                        : Regions(label_image.mat, own_regions));
  });
}

constexpr const char* kFilterComment =
    "Filters the frame's key points, and remembers the frame.\n\n"
    "timestamp: (s), above the last frame's.\n"
    "gray: uint8, (H, W), of an undistorted camera; what is needed of it is copied.\n"
    "key_points: pixels (N, 2), or a sequence of cv2.KeyPoint.\n"
    "boxes: what the detector found in this frame, perhaps nothing ([]): DetectionBoxes, or rows "
    "x_min, y_min, x_max, y_max, score, class. None: it has not said anything about this frame "
    "(it is slower than the camera), and its last boxes are carried on for two seconds at most.\n"
    "depth: float32 (m), (H, W); 0 or NaN = none. None = no depth camera.\n"
    "point_depth: N depths (m). None = the depth image's nearest pixels.\n"
    "labels: in place of boxes, an image of regions (uint8, uint16, int32), 0 = background; "
    "regions: LabelRegions that may move, all where it is None.\n"
    "predicted_pose: where your motion model expects the camera (camera from world), (4, 4).\n"
    "matched_timestamp, matched_pixels: your own matches with an earlier frame, (N, 2), NaN = "
    "none.\n\n"
    "ValueError for an image of the wrong type or size, or arrays of unequal sizes; the frame is "
    "then not remembered.";

}  // namespace

void bindFrameFilter(py::module_& module) {
  HMCDYN_BIND_RESULT(module, FrameFilterResult);
  {
    auto type = optionsClass<FrameFilterOptions>(module, "FrameFilterOptions",
                                                 commentOf("FrameFilterOptions"));
    HMCDYN_FIELDS_FrameFilterOptions(HMCDYN_OPTION);
    type.def_static("paper", &FrameFilterOptions::paper, commentOf("FrameFilterOptions::paper"));
    type.def_static("robust", &FrameFilterOptions::robust, commentOf("FrameFilterOptions::robust"));
  }
  module.def("without", &without, py::arg("ablation"), py::arg("options"), commentOf("without"));

  py::class_<SharedFilter> type(module, "FrameFilter", commentOf("FrameFilter"));
  type.def(py::init([](const OptionsOf<FrameFilterOptions>& options, const py::kwargs& fields) {
             return std::make_unique<SharedFilter>(
                 FrameFilter(optionsFrom<FrameFilterOptions>(options, fields)));
           }),
           py::arg("options") = py::none(), commentOf("FrameFilter::FrameFilter"));
  type.def("filter", &filterFrame, py::arg("timestamp"), py::arg("gray"), py::arg("key_points"),
           py::arg("boxes") = py::none(), py::kw_only(), py::arg("depth") = py::none(),
           py::arg("point_depth") = py::none(), py::arg("labels") = py::none(),
           py::arg("regions") = py::none(), py::arg("predicted_pose") = py::none(),
           py::arg("matched_timestamp") = 0.0, py::arg("matched_pixels") = py::none(),
           kFilterComment);
  type.def(
      "set_pose",
      [](SharedFilter& self, double timestamp, const ArrayLike& camera_from_world) {
        const Pose pose(motionOf(camera_from_world, "camera_from_world"));
        self.with([&](FrameFilter& filter) { filter.setPose(timestamp, pose); });
      },
      py::arg("timestamp"), py::arg("camera_from_world"), commentOf("FrameFilter::setPose"));
  type.def(
      "reset", [](SharedFilter& self) { self.with([](FrameFilter& filter) { filter.reset(); }); },
      commentOf("FrameFilter::reset"));
  type.def(
      "mask",
      [](SharedFilter& self) {
        return self.with([](FrameFilter& filter) {
          const MotionMask* const mask = filter.mask();
          return mask == nullptr ? std::optional<MotionMask>() : copyOf(*mask);
        });
      },
      "The motion mask of the last frame; None where none is made (no camera, no depth image, "
      "paper()). Its images are copies, which the next call leaves alone.");
  type.def_property_readonly(
      "options",
      [](SharedFilter& self) {
        return self.with([](FrameFilter& filter) { return FrameFilterOptions(filter.options()); });
      },
      commentOf("FrameFilter::options"));
}

}  // namespace hmcdyn::python

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "slam/detect/detector.hpp"
#include "slam/detect/detector_options.hpp"

namespace hmcdyn::slam {

/// YOLOv5 or YOLOv8 as ONNX, run by OpenCV; the head is told by its output's shape.
/// @throws std::invalid_argument where the model is not given.
/// @throws std::runtime_error that names the file and the OpenCV version where the file is
/// missing, the importer refuses it (OpenCV 4.6 knows neither float16 weights nor stock YOLOv8
/// exports), it does not run with this input size; or that says what the network looks like where
/// no output has a head's shape and a head's values.
std::unique_ptr<ObjectDetector> makeOnnxDetector(const DetectorOptions& options);

}  // namespace hmcdyn::slam

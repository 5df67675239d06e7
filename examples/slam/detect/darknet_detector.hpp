// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "slam/detect/detector.hpp"
#include "slam/detect/detector_options.hpp"

namespace hmcdyn::slam {

/// YOLO in Darknet's format (.cfg and .weights), run by OpenCV. The image is scaled to the
/// network's input side by side, as Darknet itself does, without keeping its aspect.
/// @throws std::invalid_argument where model or weights are not given.
/// @throws std::runtime_error that names the file where it is missing, does not load, was not
/// trained on COCO, or where the weights have another length than the .cfg asks for (OpenCV 4.6
/// loads empty and truncated ones without a word).
std::unique_ptr<ObjectDetector> makeDarknetDetector(const DetectorOptions& options);

}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "slam/detection/detector.hpp"
#include "slam/detection/detector_options.hpp"

namespace hmcdyn::slam {

/// A box with the time stamp (s) of its image.
struct TimedBox {
  double timestamp = 0.0;
  DetectionBox box;
};

/// Boxes from a text file with lines "timestamp class x_min y_min x_max y_max score": seconds, a
/// COCO class as number or name ("person", "traffic light"), pixels, and 0..1. Lines that start
/// with '#' are comments. Images without a line have no box, and a file without any is fine. An
/// inverted box (a maximum below its minimum) is kept as it is: it holds no point.
/// @return the boxes by time stamp, those of one time stamp as the file has them.
/// @throws std::runtime_error with file and line where a line is malformed or has a NaN.
std::vector<TimedBox> readBoxFile(const std::filesystem::path& file);

/// Gives the boxes of the nearest time stamp in a file, if it is within the tolerance; then
/// threshold, classes and clipping as for every detector.
/// @throws std::invalid_argument where the file is not given.
/// @throws std::runtime_error as readBoxFile().
std::unique_ptr<ObjectDetector> makeFileDetector(const DetectorOptions& options);

}  // namespace hmcdyn::slam

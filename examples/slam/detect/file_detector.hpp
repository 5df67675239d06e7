// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "slam/detect/box_plausibility.hpp"
#include "slam/detect/detector.hpp"
#include "slam/detect/detector_options.hpp"

namespace hmcdyn::slam {

/// Boxes from a text file with lines "timestamp class x_min y_min x_max y_max score": seconds, a
/// COCO class as number or name ("person", "traffic light"), pixels, and 0..1, in a table as
/// parseTable() reads it. Images without a line have no box, and a file without any is fine. What
/// cannot be a box is kept as it is; reviewBoxes() judges it.
/// @return the boxes by time stamp as written, those of one time stamp as the file has them.
/// @throws std::runtime_error with file and line where a line is malformed or has a NaN.
std::vector<TimedBox> readBoxFile(const std::filesystem::path& file);

/// What reviewBoxes() leaves of a file's boxes; what was assumed of its text is noted first.
/// @throws std::runtime_error as readBoxFile() and reviewBoxes().
BoxReview reviewBoxFile(const std::filesystem::path& file, const DetectorOptions& options);

/// Gives the boxes that reviewBoxes() left of a file, of the nearest time stamp if it is within the
/// tolerance, clipped to the image.
/// @throws std::invalid_argument where the file is not given.
/// @throws std::runtime_error as reviewBoxFile().
std::unique_ptr<ObjectDetector> makeFileDetector(const DetectorOptions& options);

}  // namespace hmcdyn::slam

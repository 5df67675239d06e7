// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>

#include <opencv2/core.hpp>

#include "slam/detect/detector.hpp"
#include "slam/detect/detector_options.hpp"

namespace hmcdyn::slam {

/// What a command said of one image.
struct CommandAnswer {
  std::vector<DetectionBox> boxes;
  std::string mask_file;       ///< A PNG; empty = none.
  std::size_t mask_bytes = 0;  ///< Bytes of a PNG that follow the line; 0 = none.
};

/// Reads the line that a command answers with (docs/detectors.md has the protocol).
/// @param frame the number that it was asked for.
/// @throws std::runtime_error saying what is wrong with the line: no JSON, another frame, a box of
/// other than six fields, an unknown class, a number that is not finite, or the command's own
/// error.
CommandAnswer parseCommandAnswer(const std::string& line, std::size_t frame);

/// Asks a program of the user's, in any language, image by image (docs/detectors.md has the
/// protocol). One that dies, hangs, or answers what cannot be used is started again, up to
/// CommandOptions::restarts times, and the image at which it happened has failed.
/// @throws std::invalid_argument where the command is not given.
/// @throws std::runtime_error with the command's standard error where it does not begin.
std::unique_ptr<ObjectDetector> makeCommandDetector(const DetectorOptions& options);

}  // namespace hmcdyn::slam

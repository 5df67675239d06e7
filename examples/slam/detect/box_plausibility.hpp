// SPDX-License-Identifier: BSD-3-Clause
// What boxes of a file can be: the one place that says so.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include <hmcdyn/types.hpp>

#include "slam/detect/detector_options.hpp"

namespace hmcdyn::slam {

/// More boxes than this at one time are no detector's answer: COCO's own evaluation takes 100. What
/// follows compares boxes with each other, so it must be bounded.
inline constexpr std::size_t kMostBoxes = 300;

/// A box with the time stamp (s) of its image.
struct TimedBox {
  double timestamp = 0.0;
  DetectionBox box;
};

/// Boxes of a file by the first rule that leaves them out, in this order, and `beyond`.
struct BoxCounts {
  std::size_t in_file = 0;
  std::size_t shares = 0;       ///< All corners within the first pixel: shares of the image.
  std::size_t inverted = 0;     ///< A maximum not above its minimum.
  std::size_t outside = 0;      ///< Wholly outside the image.
  std::size_t other_class = 0;  ///< Of no class that is asked for.
  std::size_t low_score = 0;    ///< Below the threshold.
  std::size_t beyond = 0;       ///< Of those left: 5 % of the image farther than its border.
  std::size_t other_time = 0;   ///< No frame within the tolerance of the time stamp.
  std::size_t weaker = 0;       ///< Beyond kMostBoxes of one time stamp, by score.
  std::size_t kept = 0;
};

/// What is left of a file's boxes.
struct BoxReview {
  std::vector<TimedBox> kept;  ///< In the order of the file's, time stamps in seconds.
  BoxCounts counts;
  std::vector<std::string> notes;  ///< "FILE: ...", a sentence each; what is usual is not noted.
};

/// Leaves out what cannot be a box of the frames, or is not asked for. Time stamps in another unit
/// become seconds where that makes them fit the frames. What is not known of the frames
/// (DetectorOptions::frames) is not checked.
/// @param file named in messages.
/// @throws std::runtime_error with a guess of what the file holds where no line is plausible: none
/// a box in the image, none at a frame's time; or many inverted, and all good in another order.
BoxReview reviewBoxes(const std::vector<TimedBox>& boxes, const DetectorOptions& options,
                      const std::filesystem::path& file);

}  // namespace hmcdyn::slam

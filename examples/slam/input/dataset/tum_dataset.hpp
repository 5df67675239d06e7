// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "support/time_stamps.hpp"

namespace hmcdyn::slam {

/// Where a frame of a data set lies.
struct FrameEntry {
  std::size_t index = 0;        ///< Place in the list, from 0.
  double timestamp = 0.0;       ///< Of the colour image (s); formatTimestamp() writes it back.
  std::filesystem::path rgb;    ///< Colour image.
  std::filesystem::path depth;  ///< Depth image, registered to the colour image.
};

/// How colour and depth images are paired.
struct DatasetOptions {
  /// File with lines "time rgb_file time depth_file". Empty = associations.txt in the folder
  /// where there is one, else rgb.txt and depth.txt are paired by time stamp.
  std::filesystem::path associations;
  /// Largest difference of paired time stamps (s), for rgb.txt with depth.txt. At least 0.
  double time_tolerance = 0.02;
  /// What the lists' time stamps count; none = found out by reviewStamps().
  std::optional<support::TimeUnit> time_unit;
  double frame_rate = 30.0;  ///< Frames a second, where the time stamps are frame numbers.
};

/// The frames of a folder, and what became of its lists.
struct FrameList {
  std::vector<FrameEntry> frames;
  std::size_t color_without_depth = 0;  ///< Colour images without a depth image in time.
  std::size_t depth_without_color = 0;  ///< Depth images without a colour image in time.
  double unit_seconds = 1.0;            ///< Of the time stamps in the colour images' list.
  std::vector<std::string> notes;       ///< What was assumed or left out, a sentence each.
};

/// The frames of a folder in the format of the TUM RGB-D benchmark (BONN's is the same), in the
/// order of their time stamps. Lines may be commented out with '#'; a line that is repeated counts
/// once; file names are relative to the folder. An entry may name a file that is missing, since
/// lists often go beyond the images at hand: loadFrame() reports it.
/// @throws std::invalid_argument where the tolerance is negative or NaN.
/// @throws std::runtime_error that names folder, file and line where the folder or a list is
/// missing, empty or malformed, a time stamp names two files, it is unclear what the time stamps
/// count, no two are within the tolerance, or not one frame has both its files.
FrameList readFrameList(const std::filesystem::path& folder, const DatasetOptions& options = {});

/// The frames of readFrameList() alone.
std::vector<FrameEntry> listFrames(const std::filesystem::path& folder,
                                   const DatasetOptions& options = {});

/// A time stamp (s) with six decimals, as TUM writes it. A double holds a time since 1970 to
/// 2.4e-7 s, half of the sixth decimal: stamps of up to six decimals come back digit by digit.
std::string formatTimestamp(double timestamp);

}  // namespace hmcdyn::slam

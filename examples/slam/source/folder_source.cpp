// SPDX-License-Identifier: BSD-3-Clause
#include "slam/source/folder_source.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <opencv2/core.hpp>

namespace hmcdyn::slam {

TumFolderSource::TumFolderSource(const std::filesystem::path& folder, const DatasetOptions& options,
                                 const CameraCalibration& calibration, Report report)
    : folder_(folder),
      entries_(listFrames(folder, options)),
      calibration_(calibration),
      report_(std::move(report)) {}

void TumFolderSource::limit(std::size_t max_frames) {
  if (max_frames > 0 && max_frames < entries_.size()) {
    entries_.resize(max_frames);
  }
}

std::optional<RgbdFrame> TumFolderSource::next() {
  while (position_ < entries_.size()) {
    const FrameEntry& entry = entries_[position_++];
    ++counts_.taken_up;
    try {
      RgbdFrame frame = loadFrame(entry, calibration_);
      counts_.without_depth += cv::countNonZero(frame.depth) == 0 ? 1 : 0;
      return frame;
    } catch (const std::runtime_error& error) {
      ++counts_.unreadable;
      report_(fmt::format("frame {} is left out: {}", entry.index, error.what()));
    }
  }
  return std::nullopt;
}

std::string TumFolderSource::name() const {
  const std::filesystem::path whole = std::filesystem::absolute(folder_).lexically_normal();
  return fmt::format("folder {}",
                     (whole.has_filename() ? whole : whole.parent_path()).filename().string());
}

void TumFolderSource::skip() {
  if (position_ < entries_.size()) {
    ++position_;
    ++counts_.taken_up;
    ++counts_.dropped;
  }
}

std::optional<double> TumFolderSource::upcomingTimestamp(std::size_t before) const {
  return before < entries_.size() - position_
             ? std::optional<double>(entries_[position_ + before].timestamp)
             : std::nullopt;
}

}  // namespace hmcdyn::slam

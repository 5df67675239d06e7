// SPDX-License-Identifier: BSD-3-Clause
#include "slam/input/source/folder_source.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <opencv2/core.hpp>

namespace hmcdyn::slam {

namespace {

/// What is wrong, whichever file it is in: one reason for many frames.
std::string withoutFiles(std::string reason, const FrameEntry& entry) {
  for (const std::filesystem::path& file : {entry.rgb, entry.depth}) {
    const std::size_t at = reason.find(file.string());
    if (at != std::string::npos) {
      reason.replace(at, file.string().size(), "a file");
    }
  }
  return reason;
}

}  // namespace

TumFolderSource::TumFolderSource(const std::filesystem::path& folder, const DatasetOptions& options,
                                 const CameraCalibration& calibration, Report report)
    : TumFolderSource(readFrameList(folder, options), folder, calibration, std::move(report)) {}

TumFolderSource::TumFolderSource(FrameList list, std::filesystem::path folder,
                                 CameraCalibration calibration, Report report)
    : folder_(std::move(folder)),
      entries_(std::move(list.frames)),
      calibration_(std::move(calibration)),
      report_(std::move(report)) {
  counts_.unpaired = list.color_without_depth;
  for (const std::string& note : list.notes) {
    report_(note);
  }
}

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
      leaveOut(entry, error.what());
    }
  }
  reportTheRest();
  return std::nullopt;
}

void TumFolderSource::leaveOut(const FrameEntry& entry, const std::string& reason) {
  ++counts_.unreadable;
  if (left_out_[withoutFiles(reason, entry)]++ == 0) {
    report_(fmt::format("frame {} is left out: {}", entry.index, reason));
  }
}

void TumFolderSource::reportTheRest() {
  for (const auto& [reason, frames] : std::exchange(left_out_, {})) {
    if (frames > 1) {
      report_(fmt::format("{} frames were left out in all because {}", frames, reason));
    }
  }
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

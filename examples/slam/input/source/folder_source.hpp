// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "slam/input/camera/calibration.hpp"
#include "slam/input/dataset/tum_dataset.hpp"
#include "slam/input/source/frame_source.hpp"

namespace hmcdyn::slam {

/// The frames of a folder in TUM format, as listFrames() gives them.
class TumFolderSource final : public RecordedSource {
 public:
  /// @param report takes a line for the first frame that cannot be read for a reason, and one with
  /// the count at the end; at first what readFrameList() noted.
  /// @throws std::runtime_error as readFrameList().
  TumFolderSource(const std::filesystem::path& folder, const DatasetOptions& options,
                  const CameraCalibration& calibration, Report report);

  /// The frames of a list that was read before.
  TumFolderSource(FrameList list, std::filesystem::path folder, CameraCalibration calibration,
                  Report report);

  /// Ends after so many entries of the list; 0 = all.
  void limit(std::size_t max_frames);

  std::optional<RgbdFrame> next() override;
  std::optional<std::size_t> expectedFrames() const override { return entries_.size(); }
  std::string name() const override;
  SourceCounts counts() const override { return counts_; }

  std::optional<double> upcomingTimestamp(std::size_t before) const override;
  void skip() override;

 private:
  void leaveOut(const FrameEntry& entry, const std::string& reason);
  void reportTheRest();

  std::filesystem::path folder_;
  std::vector<FrameEntry> entries_;
  CameraCalibration calibration_;
  Report report_;
  std::size_t position_ = 0;  ///< Of the next entry.
  SourceCounts counts_;
  std::map<std::string, std::size_t> left_out_;  ///< Frames by reason, without the files' names.
};

}  // namespace hmcdyn::slam

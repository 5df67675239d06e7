// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "slam/output/report/pictures.hpp"
#include "slam/output/report/report.hpp"

namespace hmcdyn::slam {

/// The report's frames of a run whose length is not known in advance, in bounded memory: a camera
/// may run for days. When there are too many, of each two neighbours one goes: a tracked one before
/// a lost one, then one that is no key frame, then the later.
class FrameHistory {
 public:
  /// @param capacity frames kept at most; the default is 20 minutes at 30 Hz, some 10 MB.
  /// @throws std::invalid_argument for a capacity below 2.
  explicit FrameHistory(std::size_t capacity = 36000);

  /// Numbers the frame (ReportFrame::number) and keeps it, for now.
  void add(ReportFrame frame);

  std::size_t added() const noexcept { return added_; }  ///< In all.
  std::vector<ReportFrame>& frames() noexcept { return frames_; }
  const std::vector<ReportFrame>& frames() const noexcept { return frames_; }

 private:
  void thin();

  std::size_t capacity_;
  std::size_t added_ = 0;
  std::vector<ReportFrame> frames_;
};

/// Pictures by place in `frames` in place of the number in the run: that of the last kept frame up
/// to it.
/// @param frames numbered, in rising order.
std::vector<FramePicture> byPlace(std::vector<FramePicture> pictures,
                                  const std::vector<ReportFrame>& frames);

}  // namespace hmcdyn::slam

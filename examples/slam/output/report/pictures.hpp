// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include <hmcdyn/span.hpp>

#include "slam/output/report/report.hpp"

namespace hmcdyn::slam {

/// Bytes of a JPEG file. A wider picture is made narrower.
/// @param bgr CV_8UC3. @param max_width px, above 0. @param quality 1..100.
/// @throws std::invalid_argument on an empty picture, another type, or an option out of range.
std::string encodeJpeg(const cv::Mat& bgr, int max_width = 640, int quality = 80);

/// A picture of one frame.
struct FramePicture {
  std::size_t frame = 0;  ///< Index in ReportInput::frames.
  std::string jpeg;
};

/// Pictures spread evenly over a run whose length is not known in advance, in bounded memory: of
/// every stride-th frame; when it is full, every second one goes and the stride doubles. So between
/// half and all of the capacity is used, whatever the length.
class PictureReel {
 public:
  /// @throws std::invalid_argument for a capacity below 2.
  explicit PictureReel(std::size_t capacity = 48);

  /// True where the frame with this index should be added: ask before a picture is drawn.
  bool wants(std::size_t frame) const noexcept { return frame % stride_ == 0; }

  /// Does nothing for a frame that is not wanted. Frames come in order.
  void add(std::size_t frame, std::string jpeg);

  const std::vector<FramePicture>& pictures() const noexcept { return pictures_; }

 private:
  std::size_t capacity_;
  std::size_t stride_ = 1;
  std::vector<FramePicture> pictures_;
};

/// Chooses pictures for the report: the one nearest to the frame with the largest error, where
/// errors are known, the others evenly over the run; in order of time, with captions.
/// @param frames those of the report. @param count pictures at most.
std::vector<ReportPicture> choosePictures(const std::vector<FramePicture>& pictures,
                                          const std::vector<ReportFrame>& frames,
                                          std::size_t count = 9);

}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

#include <opencv2/core.hpp>

namespace hmcdyn::slam {

/// A folder of label images, one a frame: PNG, 8 or 16 bit, one channel, 0 = background; a file is
/// named by the time stamp (s) of the colour image that it belongs to, such as
/// 1341846434.710184.png, or by the milli-, micro- or nanoseconds since 1970. What
/// hmcdyn_synthesize writes as mask/ is one. Files that are no PNG are not looked at; images are
/// read when they are asked for.
class MaskFolder {
 public:
  /// @param size of the camera's images, which the first mask must have.
  /// @param time_tolerance largest difference between the stamps of an image and its mask (s).
  /// @throws std::runtime_error naming the folder where it cannot be read or has no PNG, or the
  /// file whose name is no time stamp, or as at() for the first mask.
  MaskFolder(std::filesystem::path folder, cv::Size size, double time_tolerance);

  /// Whether a mask's time stamp is near enough.
  bool has(double timestamp) const;

  /// The mask of the nearest time stamp, as it is in the file.
  /// @throws std::runtime_error naming the file: where none is near enough, or it is damaged, of
  /// another size, not 8 or 16 bit with one channel, or has so many labels (more than 100 in 16
  /// bit) that it must be a depth image: BoxCarrier compares every region with every other.
  cv::Mat at(double timestamp) const;

 private:
  struct Entry {
    double timestamp = 0.0;
    std::filesystem::path file;
  };

  const Entry& nearest(double timestamp) const;
  cv::Mat read(const std::filesystem::path& file) const;

  std::filesystem::path folder_;
  cv::Size size_;
  double time_tolerance_;
  std::vector<Entry> entries_;  ///< By time stamp; not empty.
};

}  // namespace hmcdyn::slam

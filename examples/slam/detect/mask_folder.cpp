// SPDX-License-Identifier: BSD-3-Clause
#include "slam/detect/mask_folder.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "slam/input/dataset/image_file.hpp"
#include "support/time_stamps.hpp"

namespace hmcdyn::slam {
namespace {

double stampOf(const std::filesystem::path& file) {
  const std::string name = file.stem().string();
  std::size_t read = 0;
  double stamp = std::nan("");
  try {
    stamp = std::stod(name, &read);
  } catch (const std::logic_error&) {
    read = 0;  // no number, or one out of range
  }
  if (read != name.size() || !std::isfinite(stamp)) {
    throw std::runtime_error(
        fmt::format("{}: '{}' is no time stamp; expected a mask named as the time (s) of its "
                    "colour image, such as 1341846434.710184.png",
                    file.string(), name));
  }
  return stamp;
}

/// Number of different values above 0.
std::size_t labelsIn(const cv::Mat& mask) {
  std::vector<std::uint8_t> is_there(std::size_t{std::numeric_limits<std::uint16_t>::max()} + 1, 0);
  for (int row = 0; row < mask.rows; ++row) {
    const auto* const label = mask.ptr<std::uint16_t>(row);
    for (int column = 0; column < mask.cols; ++column) {
      is_there[label[column]] = 1;
    }
  }
  return static_cast<std::size_t>(std::count(is_there.begin() + 1, is_there.end(), 1));
}

/// Depth images are 16 bit with one channel, too, but have hundreds of values.
void refuseDepth(const cv::Mat& mask, const std::filesystem::path& file) {
  constexpr std::size_t kMost = 100;  // things in an image, as COCO's evaluation has it
  const std::size_t labels = mask.type() == CV_16UC1 ? labelsIn(mask) : 0;
  if (labels > kMost) {
    throw std::runtime_error(fmt::format(
        "{}: has {} different labels on {:.0f} % of the image; expected 0 = background and a "
        "number a thing that may move, {} at most; are these depth images? Give --masks the folder "
        "of the masks",
        file.string(), labels, 100.0 * cv::countNonZero(mask) / static_cast<double>(mask.total()),
        kMost));
  }
}

}  // namespace

MaskFolder::MaskFolder(std::filesystem::path folder, cv::Size size, double time_tolerance)
    : folder_(std::move(folder)), size_(size), time_tolerance_(time_tolerance) {
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder_, error)) {
    if (entry.path().extension() == ".png") {
      entries_.push_back({stampOf(entry.path()), entry.path()});
    }
  }
  if (error) {
    throw std::runtime_error(
        fmt::format("{}: {}; expected a folder of masks", folder_.string(), error.message()));
  }
  if (entries_.empty()) {
    throw std::runtime_error(
        fmt::format("{}: holds no .png; expected masks, one a frame", folder_.string()));
  }
  if (const auto unit = support::unitSince1970(entries_.front().timestamp)) {
    for (Entry& entry : entries_) {
      entry.timestamp *= support::secondsOf(*unit, 1.0);
    }
  }
  std::sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) {
    return a.timestamp < b.timestamp || (a.timestamp == b.timestamp && a.file < b.file);
  });
  read(entries_.front().file);
}

cv::Mat MaskFolder::read(const std::filesystem::path& file) const {
  cv::Mat mask = readImage(file);
  if (mask.type() != CV_8UC1 && mask.type() != CV_16UC1) {
    throw std::runtime_error(
        fmt::format("{}: is {}; expected a mask of 8 or 16 bit with one channel", file.string(),
                    cv::typeToString(mask.type())));
  }
  if (mask.size() != size_) {
    throw std::runtime_error(
        fmt::format("{}: is {} x {} px; expected a mask of {} x {}, as the "
                    "camera's images",
                    file.string(), mask.cols, mask.rows, size_.width, size_.height));
  }
  refuseDepth(mask, file);
  return mask;
}

const MaskFolder::Entry& MaskFolder::nearest(double timestamp) const {
  const auto later =
      std::lower_bound(entries_.begin(), entries_.end(), timestamp,
                       [](const Entry& entry, double time) { return entry.timestamp < time; });
  if (later == entries_.end() ||
      (later != entries_.begin() &&
       timestamp - std::prev(later)->timestamp <= later->timestamp - timestamp)) {
    return *std::prev(later);
  }
  return *later;
}

bool MaskFolder::has(double timestamp) const {
  return std::abs(nearest(timestamp).timestamp - timestamp) <= time_tolerance_;
}

cv::Mat MaskFolder::at(double timestamp) const {
  if (!has(timestamp)) {
    throw std::runtime_error(fmt::format("{}: is missing, and no mask is within {} s of it",
                                         (folder_ / fmt::format("{:.6f}.png", timestamp)).string(),
                                         time_tolerance_));
  }
  return read(nearest(timestamp).file);
}

}  // namespace hmcdyn::slam

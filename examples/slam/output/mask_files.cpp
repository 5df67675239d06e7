// SPDX-License-Identifier: BSD-3-Clause
#include "slam/output/mask_files.hpp"

#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

#include <hmcdyn/motion_mask.hpp>

#include "slam/input/dataset/frame.hpp"
#include "slam/output/append_file.hpp"

namespace hmcdyn::slam {
namespace {

void writePng(const std::filesystem::path& file, const cv::Mat& image) {
  std::vector<std::uint8_t> bytes;
  // Run lengths (level 1) are as small as anything here, and the fastest.
  const std::vector<int> settings{cv::IMWRITE_PNG_COMPRESSION, 1, cv::IMWRITE_PNG_STRATEGY,
                                  cv::IMWRITE_PNG_STRATEGY_RLE};
  if (!cv::imencode(".png", image, bytes, settings)) {
    throw std::runtime_error(file.string() + ": cannot be encoded");
  }
  replaceFile(file, std::string(bytes.begin(), bytes.end()));
}

}  // namespace

std::filesystem::path stampedImage(const std::filesystem::path& folder, double timestamp) {
  return folder / (formatTimestamp(timestamp) + ".png");
}

void writeMask(const std::filesystem::path& folder, double timestamp, const cv::Mat& label) {
  if (label.empty() || label.type() != CV_8UC1) {
    throw std::invalid_argument(
        fmt::format("mask of {}x{}, type {}; expected pixels of type CV_8UC1", label.cols,
                    label.rows, label.type()));
  }
  writePng(stampedImage(folder, timestamp), label);
}

void writeStaticDepth(const std::filesystem::path& folder, double timestamp, const cv::Mat& depth,
                      const cv::Mat& label, double depth_factor) {
  if (!(depth_factor > 0.0)) {
    throw std::invalid_argument(
        fmt::format("static depth: depth factor {}; expected above 0", depth_factor));
  }
  cv::Mat metres = staticDepth(depth, label);
  constexpr double kLargest = std::numeric_limits<std::uint16_t>::max();
  metres.setTo(0.0, metres > kLargest / depth_factor);
  cv::Mat values;
  metres.convertTo(values, CV_16U, depth_factor);  // rounds; NaN and what is below 0 become 0
  writePng(stampedImage(folder, timestamp), values);
}

}  // namespace hmcdyn::slam

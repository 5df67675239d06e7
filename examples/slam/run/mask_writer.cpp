// SPDX-License-Identifier: BSD-3-Clause
#include "slam/run/mask_writer.hpp"

#include <stdexcept>
#include <system_error>
#include <utility>

#include "slam/output/mask_files.hpp"

namespace hmcdyn::slam {
namespace {

constexpr std::size_t kFramesWaiting = 8;

/// @return the folder, or an empty path where it is not asked for.
std::filesystem::path folderFor(bool asked, const std::filesystem::path& output, const char* name) {
  if (!asked) {
    return {};
  }
  std::filesystem::path folder = output / name;
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    throw std::runtime_error(folder.string() + ": cannot be created: " + error.message());
  }
  return folder;
}

cv::Mat labelsOf(const FrameOutcome& outcome) {
  if (outcome.motion == nullptr) {
    return {outcome.image.depth.size(), CV_8UC1,
            cv::Scalar::all(static_cast<double>(MaskLabel::kUnknown))};
  }
  return outcome.motion->label.clone();  // the filter writes the next frame's there
}

}  // namespace

MaskWriter::MaskWriter(const SlamOptions& options, double depth_factor)
    : worker_(
          [masks = folderFor(options.write_masks, options.output, kMaskFolder),
           static_depth = folderFor(options.write_static_depth, options.output, kStaticDepthFolder),
           depth_factor](const Job& job) {
            if (!masks.empty()) {
              writeMask(masks, job.timestamp, job.label);
            }
            if (!static_depth.empty()) {
              writeStaticDepth(static_depth, job.timestamp, job.depth, job.label, depth_factor);
            }
            return std::monostate{};
          },
          kFramesWaiting) {}

void MaskWriter::add(const FrameOutcome& outcome) {
  worker_.submit({outcome.image.timestamp, labelsOf(outcome), outcome.image.depth});
  while (worker_.tryTake()) {
  }
}

void MaskWriter::finish() {
  while (worker_.pending() > 0) {
    worker_.take();
  }
}

}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#include "slam/input/dataset/recording.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <opencv2/core.hpp>

#include "slam/input/camera/plausibility.hpp"
#include "slam/input/dataset/image_file.hpp"

namespace hmcdyn::slam {
namespace {

/// What a few frames, spread over the list, say of all.
struct Probe {
  cv::Size image;             ///< Of most of the colour images; 0 x 0 where none can be read.
  std::vector<float> depths;  ///< Values of the depth images above 0, as they are in the files.
};

void addDepths(const cv::Mat& depth, std::vector<float>& values) {
  constexpr int kStep = 7;  // px: thousands of values a frame are enough for a median
  for (int row = 0; row < depth.rows; row += kStep) {
    for (int column = 0; column < depth.cols; column += kStep) {
      if (const std::uint16_t value = depth.at<std::uint16_t>(row, column); value > 0) {
        values.push_back(value);
      }
    }
  }
}

Probe probe(const std::vector<FrameEntry>& frames) {
  constexpr std::size_t kProbes = 5;
  std::vector<const FrameEntry*> there;  // lists often go beyond the images at hand
  for (const FrameEntry& frame : frames) {
    if (std::filesystem::exists(frame.rgb)) {
      there.push_back(&frame);
    }
  }
  Probe result;
  std::map<std::pair<int, int>, int> sizes;
  const std::size_t step = std::max<std::size_t>(1, there.size() / kProbes);
  for (std::size_t i = 0; i < there.size(); i += step) {
    try {
      const cv::Mat color = readImage(there[i]->rgb);
      ++sizes[{color.cols, color.rows}];
      const cv::Mat depth = readImage(there[i]->depth);
      if (depth.type() == CV_16UC1) {
        addDepths(depth, result.depths);
      }
    } catch (const std::runtime_error&) {  // loadFrame() will say so
    }
  }
  const auto most = std::max_element(
      sizes.begin(), sizes.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  if (most != sizes.end()) {
    result.image = {most->first.first, most->first.second};
  }
  return result;
}

}  // namespace

void requireSize(const CameraCalibration& calibration, const std::string& camera,
                 const char* source) {
  if (calibration.width <= 0 || calibration.height <= 0) {
    throw std::runtime_error(fmt::format(
        "camera {}: Camera.width and Camera.height are missing, and {}", camera, source));
  }
}

Recording openRecording(const std::filesystem::path& folder, const std::string& camera,
                        DatasetOptions options) {
  Recording recording;
  recording.calibration = loadCamera(camera);
  options.frame_rate = recording.calibration.frame_rate;
  recording.list = readFrameList(folder, options);
  const Probe seen = probe(recording.list.frames);
  if (seen.image.area() == 0) {
    requireSize(recording.calibration, camera, "no image can be read that would say them");
    return recording;
  }
  recording.calibration = fittedTo(recording.calibration, seen.image, camera);
  for (const std::string& unusual : whatIsUnusual(recording.calibration)) {
    recording.list.notes.push_back(fmt::format("camera {}: {}", camera, unusual));
  }
  std::vector<float> metres = seen.depths;
  for (float& depth : metres) {
    depth /= static_cast<float>(recording.calibration.depth_factor);
  }
  const std::string odd = whatIsOddAbout(std::move(metres), recording.calibration.depth_factor);
  if (!odd.empty()) {
    recording.list.notes.push_back(fmt::format("camera {}: {}", camera, odd));
  }
  return recording;
}

FramesOfBoxes framesOfBoxes(const CameraCalibration& calibration, const FrameList& list) {
  FramesOfBoxes frames;
  frames.image = {calibration.width, calibration.height};
  frames.unit_seconds = list.unit_seconds;
  for (const FrameEntry& frame : list.frames) {
    frames.times.push_back(frame.timestamp);
  }
  return frames;
}

}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#include "slam/input/source/live_source.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

namespace hmcdyn::slam {
namespace {

std::string sizeOf(const cv::Mat& image) {
  return fmt::format("{} x {} pixels", image.cols, image.rows);
}

/// Why the images cannot be used; empty = they can.
std::string problemOf(const CameraImages& images, const CameraCalibration& calibration,
                      std::optional<double> last_timestamp) {
  const cv::Size expected(calibration.width, calibration.height);
  if (images.color.empty()) {
    return "there is no colour image";
  }
  if (images.color.size() != expected) {
    return fmt::format("the colour image has {}; the calibration says {} x {}",
                       sizeOf(images.color), expected.width, expected.height);
  }
  if (images.color.type() != CV_8UC3 && images.color.type() != CV_8UC1) {
    return fmt::format("the colour image is of type {}; expected CV_8UC3 or CV_8UC1",
                       cv::typeToString(images.color.type()));
  }
  if (!images.depth.empty() && images.depth.size() != expected) {
    return fmt::format("the depth image has {}, the colour image {}; is depth registered?",
                       sizeOf(images.depth), sizeOf(images.color));
  }
  if (!images.depth.empty() && images.depth.type() != CV_16UC1 && images.depth.type() != CV_32FC1) {
    return fmt::format("the depth image is of type {}; expected CV_16UC1 or CV_32FC1",
                       cv::typeToString(images.depth.type()));
  }
  if (!std::isfinite(images.timestamp)) {
    return "the time stamp is not a number";
  }
  if (last_timestamp && images.timestamp <= *last_timestamp) {
    return fmt::format("time stamp {:.6f} is not after the frame before, {:.6f}", images.timestamp,
                       *last_timestamp);
  }
  return {};
}

/// Metres, 0 = none.
cv::Mat toMetres(const cv::Mat& depth, double unit, cv::Size size) {
  if (depth.empty()) {
    return cv::Mat::zeros(size, CV_32FC1);
  }
  cv::Mat metres;
  depth.convertTo(metres, CV_32F, unit);
  if (depth.type() == CV_32FC1) {
    std::replace_if(
        metres.begin<float>(), metres.end<float>(), [](float z) { return !hasDepth(z); }, 0.0f);
  }
  return metres;
}

RgbdFrame toFrame(const CameraImages& images, double unit, std::size_t index) {
  RgbdFrame frame;
  frame.index = index;
  frame.timestamp = images.timestamp;
  if (images.color.type() == CV_8UC1) {
    frame.gray = images.color.clone();
    cv::cvtColor(frame.gray, frame.bgr, cv::COLOR_GRAY2BGR);
  } else {
    frame.bgr = images.color.clone();
    cv::cvtColor(frame.bgr, frame.gray, cv::COLOR_BGR2GRAY);
  }
  frame.depth = toMetres(images.depth, unit, images.color.size());
  return frame;
}

}  // namespace

LiveSource::LiveSource(std::unique_ptr<DepthCamera> camera, CameraCalibration calibration,
                       Report report, const LiveSourceOptions& options)
    : camera_(std::move(camera)),
      calibration_(std::move(calibration)),
      report_(std::move(report)),
      options_(options) {
  if (!camera_) {
    throw std::invalid_argument("LiveSource: camera is null");
  }
  if (options_.max_unusable == 0) {
    throw std::invalid_argument("LiveSourceOptions::max_unusable is 0; expected 1 or more");
  }
}

std::optional<RgbdFrame> LiveSource::next() {
  while (failure_.empty()) {
    const std::optional<CameraImages> images = camera_->read();
    if (!images) {
      fail(fmt::format("{}: no more images after {} frames; was it unplugged?", camera_->name(),
                       counts_.taken_up));
      break;
    }
    const std::size_t index = counts_.taken_up++;
    const std::string problem = problemOf(*images, calibration_, last_timestamp_);
    if (!problem.empty()) {
      ++counts_.unreadable;
      if (++unusable_in_row_ == 1) {
        report_(fmt::format("{}: frame {} is left out: {}", camera_->name(), index, problem));
      }
      if (unusable_in_row_ >= options_.max_unusable) {
        fail(fmt::format("{}: {} frames in a row cannot be used; the last: {}", camera_->name(),
                         unusable_in_row_, problem));
      }
      continue;
    }
    unusable_in_row_ = 0;
    last_timestamp_ = images->timestamp;
    RgbdFrame frame = toFrame(*images, camera_->depthUnit(), index);
    const bool has_depth = cv::countNonZero(frame.depth) > 0;
    counts_.without_depth += has_depth ? 0 : 1;
    if (had_depth_ && !has_depth) {
      report_(fmt::format("{}: no depth from frame {} on", camera_->name(), index));
    }
    had_depth_ = has_depth;
    return frame;
  }
  return std::nullopt;
}

void LiveSource::fail(const std::string& reason) {
  failure_ = reason;
  report_(reason);
}

}  // namespace hmcdyn::slam

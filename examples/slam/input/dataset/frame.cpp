// SPDX-License-Identifier: BSD-3-Clause
#include "slam/input/dataset/frame.hpp"

#include <filesystem>
#include <stdexcept>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "slam/input/dataset/image_file.hpp"

namespace hmcdyn::slam {
namespace {

std::string describeType(const cv::Mat& image) {
  return fmt::format("{} channel{} of {} bits", image.channels(), image.channels() == 1 ? "" : "s",
                     8 * image.elemSize1());
}

void checkSize(const cv::Mat& image, const CameraCalibration& calibration,
               const std::filesystem::path& file) {
  if (image.cols != calibration.width || image.rows != calibration.height) {
    throw std::runtime_error(fmt::format("{}: is {} x {} pixels; the calibration says {} x {}",
                                         file.string(), image.cols, image.rows, calibration.width,
                                         calibration.height));
  }
}

cv::Mat loadColor(const FrameEntry& entry, const CameraCalibration& calibration) {
  const cv::Mat image = readImage(entry.rgb);
  cv::Mat bgr;
  switch (image.type()) {
    case CV_8UC3:
      bgr = image;
      break;
    case CV_8UC4:
      cv::cvtColor(image, bgr, cv::COLOR_BGRA2BGR);
      break;
    case CV_8UC1:
      cv::cvtColor(image, bgr, cv::COLOR_GRAY2BGR);
      break;
    default:
      throw std::runtime_error(fmt::format(
          "{}: has {}; expected a colour image of 8 bits{}", entry.rgb.string(),
          describeType(image), image.type() == CV_16UC1 ? " (are colour and depth swapped?)" : ""));
  }
  checkSize(bgr, calibration, entry.rgb);
  return bgr;
}

cv::Mat loadDepth(const FrameEntry& entry, const CameraCalibration& calibration) {
  const cv::Mat image = readImage(entry.depth);
  if (image.type() != CV_16UC1) {
    throw std::runtime_error(fmt::format("{}: has {}; expected a depth image, 1 channel of 16 bits",
                                         entry.depth.string(), describeType(image)));
  }
  checkSize(image, calibration, entry.depth);
  cv::Mat depth;
  image.convertTo(depth, CV_32F, 1.0 / calibration.depth_factor);
  return depth;
}

cv::Mat toGray(const cv::Mat& bgr) {
  cv::Mat gray;
  cv::cvtColor(bgr, gray, cv::COLOR_BGR2GRAY);
  return gray;
}

cv::Mat withoutKnownError(const cv::Mat& depth, const DepthCorrection& correction) {
  return isIdentity(correction) ? depth : correctDepth(depth, correction);
}

}  // namespace

RgbdFrame loadFrame(const FrameEntry& entry, const CameraCalibration& calibration) {
  RgbdFrame frame;
  frame.index = entry.index;
  frame.timestamp = entry.timestamp;
  frame.bgr = loadColor(entry, calibration);
  frame.gray = toGray(frame.bgr);
  frame.depth = loadDepth(entry, calibration);
  return frame;
}

RgbdFrame rectify(const RgbdFrame& frame, const Rectifier& rectifier) {
  const DepthCorrection& correction = rectifier.calibration().depth_correction;
  RgbdFrame rectified;
  if (rectifier.isIdentity()) {
    rectified = frame;
    rectified.depth = withoutKnownError(frame.depth, correction);
    return rectified;
  }
  rectified.index = frame.index;
  rectified.timestamp = frame.timestamp;
  rectified.bgr = rectifier.color(frame.bgr);
  rectified.gray = toGray(rectified.bgr);
  rectified.depth = withoutKnownError(rectifier.depth(frame.depth), correction);
  return rectified;
}

}  // namespace hmcdyn::slam

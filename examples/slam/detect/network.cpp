// SPDX-License-Identifier: BSD-3-Clause
#include "slam/detect/network.hpp"

#include <fmt/format.h>
#include <opencv2/core/version.hpp>

namespace hmcdyn::slam {

std::runtime_error modelError(const std::filesystem::path& model, const std::string& reason,
                              const std::string& advice) {
  // OpenCV's sentences end in a full stop, and in line ends.
  const std::string sentence = reason.substr(0, reason.find_last_not_of(". \r\n") + 1);
  return std::runtime_error(fmt::format("{}: OpenCV {} cannot run this model: {}; {}",
                                        model.string(), CV_VERSION, sentence, advice));
}

std::runtime_error headError(const std::filesystem::path& model, const std::string& what) {
  return std::runtime_error(
      fmt::format("{}: hmcdyn does not decode this network: {}", model.string(), what));
}

void useCpu(cv::dnn::Net& net) {
  net.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
  net.setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
}

std::vector<cv::Mat> runNetwork(cv::dnn::Net& net, const cv::Mat& bgr, cv::Size input) {
  constexpr double kScale = 1.0 / 255.0;
  constexpr bool kSwapRedAndBlue = true;
  net.setInput(cv::dnn::blobFromImage(bgr, kScale, input, cv::Scalar(), kSwapRedAndBlue));
  std::vector<cv::Mat> outputs;
  net.forward(outputs, net.getUnconnectedOutLayersNames());
  return outputs;
}

}  // namespace hmcdyn::slam

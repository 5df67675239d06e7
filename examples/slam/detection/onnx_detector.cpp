// SPDX-License-Identifier: BSD-3-Clause
#include "slam/detection/onnx_detector.hpp"

#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "slam/dataset/file_io.hpp"
#include "slam/detection/box_selection.hpp"
#include "slam/detection/letterbox.hpp"
#include "slam/detection/network.hpp"
#include "slam/detection/yolo_decode.hpp"

namespace hmcdyn::slam {
namespace {

constexpr int kDefaultInput = 640;  // of YOLOv5's and YOLOv8's exporters

cv::dnn::Net loadNet(const std::filesystem::path& model) {
  const std::string bytes = readFile(model);
  try {
    cv::dnn::Net net = cv::dnn::readNetFromONNX(bytes.data(), bytes.size());
    useCpu(net);
    return net;
  } catch (const cv::Exception& error) {
    throw modelError(model, error.err,
                     "export YOLOv5 as ONNX in float32 with opset 12, use a newer OpenCV, or take "
                     "--detector darknet");
  }
}

// YOLOv5 has exports with three more outputs, those of the single scales: the one with a head's
// shape counts.
std::vector<DetectionBox> decode(const std::vector<cv::Mat>& outputs, float score_threshold) {
  std::string refusal = "the network has no output";
  for (const cv::Mat& output : outputs) {
    try {
      return yoloHeadOf(output) == YoloHead::kYoloV5 ? decodeYoloV5(output, score_threshold)
                                                     : decodeYoloV8(output, score_threshold);
    } catch (const std::invalid_argument& error) {
      refusal = error.what();
    }
  }
  throw std::invalid_argument(refusal);
}

class OnnxDetector final : public ObjectDetector {
 public:
  OnnxDetector(const cv::dnn::Net& net, int input_size, DetectorOptions options)
      : net_(net), input_size_(input_size), options_(std::move(options)) {
    const std::string size = fmt::format("{0}x{0}", input_size_);
    try {
      detect(cv::Mat::zeros(input_size_, input_size_, CV_8UC3), 0.0);
    } catch (const cv::Exception& error) {
      throw modelError(options_.model, fmt::format("with an input of {}: {}", size, error.err),
                       "give the export's own input size (--input-size)");
    } catch (const std::invalid_argument& error) {
      throw modelError(options_.model, error.what(), "give a YOLOv5 or YOLOv8 detector");
    }
  }

  std::vector<DetectionBox> detect(const cv::Mat& bgr, double /*timestamp*/) override {
    checkColorImage(bgr);
    const Letterbox letterbox = makeLetterbox(bgr.size(), input_size_);
    const std::vector<cv::Mat> outputs =
        runNetwork(net_, toInput(bgr, letterbox), {input_size_, input_size_});
    std::vector<DetectionBox> boxes = suppressOverlaps(
        keepWanted(decode(outputs, options_.score_threshold), options_), options_.nms_threshold);
    for (DetectionBox& box : boxes) {
      box = toImage(box, letterbox);
    }
    return clipToImage(boxes, bgr.size());
  }

  std::string name() const override {
    return fmt::format("yolo {0} {1}x{1}", options_.model.filename().string(), input_size_);
  }

 private:
  cv::dnn::Net net_;
  int input_size_;
  DetectorOptions options_;
};

}  // namespace

std::unique_ptr<ObjectDetector> makeOnnxDetector(const DetectorOptions& options) {
  if (options.model.empty()) {
    throw std::invalid_argument("detector 'yolo': --model is not given; it needs --model ONNX");
  }
  const int input_size = options.input_size > 0 ? options.input_size : kDefaultInput;
  return std::make_unique<OnnxDetector>(loadNet(options.model), input_size, options);
}

}  // namespace hmcdyn::slam

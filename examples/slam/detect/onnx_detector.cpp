// SPDX-License-Identifier: BSD-3-Clause
#include "slam/detect/onnx_detector.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "slam/detect/box_selection.hpp"
#include "slam/detect/letterbox.hpp"
#include "slam/detect/network.hpp"
#include "slam/detect/yolo_decode.hpp"
#include "slam/detect/yolo_heads.hpp"
#include "slam/input/dataset/file_io.hpp"
#include "support/file_kind.hpp"

namespace hmcdyn::slam {
namespace {

constexpr int kDefaultInput = 640;  // of YOLOv5's and YOLOv8's exporters

cv::dnn::Net loadNet(const std::filesystem::path& model) {
  const std::string bytes = readFile(model);
  const char* const advice =
      "export YOLOv5 as ONNX in float32 with opset 12, use a newer OpenCV, or take --detector "
      "darknet";
  if (const std::string kind = support::kindOfBytes(bytes); !kind.empty()) {
    throw modelError(model, "it is no ONNX, but " + kind, advice);
  }
  try {
    cv::dnn::Net net = cv::dnn::readNetFromONNX(bytes.data(), bytes.size());
    useCpu(net);
    return net;
  } catch (const cv::Exception& error) {
    throw modelError(model, error.err, advice);
  }
}

bool hasHead(const cv::Mat& output) {
  try {
    yoloHeadOf(output);
    return true;
  } catch (const std::invalid_argument&) {
    return false;
  }
}

// YOLOv5 has exports with three more outputs, those of the single scales: the one with a head's
// shape counts.
const cv::Mat* headAmong(const std::vector<cv::Mat>& outputs) {
  const auto head = std::find_if(outputs.begin(), outputs.end(), hasHead);
  return head == outputs.end() ? nullptr : &*head;
}

class OnnxDetector final : public ObjectDetector {
 public:
  OnnxDetector(const cv::dnn::Net& net, int input_size, DetectorOptions options)
      : net_(net), input_size_(input_size), options_(std::move(options)) {
    const std::string size = fmt::format("{0}x{0}", input_size_);
    std::vector<cv::Mat> outputs;
    try {
      outputs = run(cv::Mat::zeros(input_size_, input_size_, CV_8UC3));
    } catch (const cv::Exception& error) {
      throw modelError(options_.model, fmt::format("with an input of {}: {}", size, error.err),
                       "give the export's own input size (--input-size)");
    }
    const cv::Mat* const head = headAmong(outputs);
    const std::string wrong =
        head == nullptr ? guessOfHead(outputs) : whatIsWrongWithHead(*head, input_size_);
    if (!wrong.empty()) {
      throw headError(options_.model, wrong);
    }
  }

  std::vector<DetectionBox> detect(const cv::Mat& bgr, double /*timestamp*/) override {
    checkColorImage(bgr);
    const std::vector<cv::Mat> outputs = run(bgr);
    const cv::Mat* const head = headAmong(outputs);
    if (head == nullptr) {
      throw headError(options_.model, guessOfHead(outputs));
    }
    const float threshold = options_.score_threshold;
    const std::vector<DetectionBox> candidates = yoloHeadOf(*head) == YoloHead::kYoloV5
                                                     ? decodeYoloV5(*head, threshold)
                                                     : decodeYoloV8(*head, threshold);
    std::vector<DetectionBox> boxes =
        suppressOverlaps(keepWanted(candidates, options_), options_.nms_threshold);
    const Letterbox letterbox = makeLetterbox(bgr.size(), input_size_);
    for (DetectionBox& box : boxes) {
      box = toImage(box, letterbox);
    }
    return clipToImage(boxes, bgr.size());
  }

  std::string name() const override {
    return fmt::format("yolo {0} {1}x{1}", options_.model.filename().string(), input_size_);
  }

 private:
  std::vector<cv::Mat> run(const cv::Mat& bgr) {
    const Letterbox letterbox = makeLetterbox(bgr.size(), input_size_);
    return runNetwork(net_, toInput(bgr, letterbox), {input_size_, input_size_});
  }

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

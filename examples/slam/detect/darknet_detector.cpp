// SPDX-License-Identifier: BSD-3-Clause
#include "slam/detect/darknet_detector.hpp"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "slam/detect/box_selection.hpp"
#include "slam/detect/network.hpp"
#include "slam/detect/yolo_decode.hpp"
#include "slam/input/dataset/file_io.hpp"

namespace hmcdyn::slam {
namespace {

constexpr const char* kAdvice = "give a YOLO .cfg and the .weights made with it, trained on COCO";

std::string withoutBlanks(const std::string& line) {
  std::string text;
  for (const char c : line) {
    if (c != ' ' && c != '\t' && c != '\r') {
      text += c;
    }
  }
  return text;
}

// What we need of a .cfg, and its text with one change.
struct Config {
  cv::Size input;
  std::string text;
};

int parseSide(const std::string& value, const std::string& key, const std::filesystem::path& file,
              std::size_t line) {
  constexpr double kLargest = 1 << 14;
  const double side = parseFinite(value, key, file, line);
  if (side < 1.0 || side > kLargest) {
    throw errorAt(file, line, fmt::format("{} is {}; expected 1..{}", key, side, kLargest));
  }
  return static_cast<int>(side);
}

// OpenCV's [yolo] layer drops what is not above its key "thresh", 0.2 unless it is given: we give
// it, so that a lower score_threshold is no empty promise.
Config readConfig(const std::filesystem::path& file, float score_threshold) {
  std::istringstream lines(readFile(file));
  Config config;
  std::string section;
  std::string line;
  for (std::size_t number = 1; std::getline(lines, line); ++number) {
    config.text += line + '\n';
    const std::string text = withoutBlanks(line);
    if (!text.empty() && text.front() == '[') {
      section = text;
      if (section == "[yolo]") {
        config.text += fmt::format("thresh={}\n", score_threshold);
      }
    }
    const std::size_t equals = text.find('=');
    if (section == "[net]" && equals != std::string::npos) {
      const std::string key = text.substr(0, equals);
      if (key == "width" || key == "height") {
        (key == "width" ? config.input.width : config.input.height) =
            parseSide(text.substr(equals + 1), key, file, number);
      }
    }
  }
  if (config.input.width < 1 || config.input.height < 1) {
    throw std::runtime_error(fmt::format(
        "{}: no section [net] with width and height: not a Darknet .cfg", file.string()));
  }
  return config;
}

// Length of the .weights (bytes) that a network was made for: a header, then each parameter.
std::size_t expectedWeightBytes(cv::dnn::Net& net, const std::string& weights) {
  std::size_t parameters = 0;
  for (const std::string& name : net.getLayerNames()) {
    const cv::Ptr<cv::dnn::Layer> layer = net.getLayer(net.getLayerId(name));
    if (layer->type != "Region") {  // its blob holds the anchors, which the .cfg has
      for (const cv::Mat& blob : layer->blobs) {
        parameters += blob.total();
      }
    }
  }
  // Three 32-bit numbers, major, minor and revision, then the images seen: 64 bits from 0.2 on.
  std::int32_t version[2] = {0, 2};
  if (weights.size() >= sizeof version) {
    std::memcpy(version, weights.data(), sizeof version);
  }
  const std::size_t header = std::int64_t{10} * version[0] + version[1] >= 2 ? 20 : 16;
  return header + parameters * sizeof(float);
}

cv::dnn::Net loadNet(const Config& config, const DetectorOptions& options) {
  const std::string weights = readFile(options.weights);
  if (weights.empty()) {
    throw modelError(options.weights, "the file is empty", kAdvice);
  }
  cv::dnn::Net net;
  try {
    net = cv::dnn::readNetFromDarknet(config.text.data(), config.text.size(), weights.data(),
                                      weights.size());
  } catch (const cv::Exception& error) {
    throw modelError(options.model, fmt::format("with {}: {}", options.weights.string(), error.err),
                     kAdvice);
  }
  const std::size_t expected = expectedWeightBytes(net, weights);
  if (weights.size() != expected) {
    throw modelError(options.weights,
                     fmt::format("{} bytes, but {} asks for {}: truncated, or of another network",
                                 weights.size(), options.model.string(), expected),
                     kAdvice);
  }
  useCpu(net);
  return net;
}

class DarknetDetector final : public ObjectDetector {
 public:
  DarknetDetector(const cv::dnn::Net& net, cv::Size input, DetectorOptions options)
      : net_(net), input_(input), options_(std::move(options)) {
    try {
      detect(cv::Mat::zeros(input_, CV_8UC3), 0.0);
    } catch (const cv::Exception& error) {
      throw modelError(
          options_.model,
          fmt::format("with an input of {}x{}: {}", input_.width, input_.height, error.err),
          kAdvice);
    } catch (const std::invalid_argument& error) {
      throw headError(options_.model, fmt::format("{}; {}", error.what(), kAdvice));
    }
  }

  std::vector<DetectionBox> detect(const cv::Mat& bgr, double /*timestamp*/) override {
    checkColorImage(bgr);
    std::vector<DetectionBox> candidates;
    for (const cv::Mat& output : runNetwork(net_, bgr, input_)) {
      const auto boxes = decodeDarknet(output, bgr.size(), options_.score_threshold);
      candidates.insert(candidates.end(), boxes.begin(), boxes.end());
    }
    return clipToImage(suppressOverlaps(keepWanted(candidates, options_), options_.nms_threshold),
                       bgr.size());
  }

  std::string name() const override {
    return fmt::format("darknet {} {}x{}", options_.model.filename().string(), input_.width,
                       input_.height);
  }

 private:
  cv::dnn::Net net_;
  cv::Size input_;
  DetectorOptions options_;
};

}  // namespace

std::unique_ptr<ObjectDetector> makeDarknetDetector(const DetectorOptions& options) {
  if (options.model.empty() || options.weights.empty()) {
    throw std::invalid_argument(fmt::format(
        "detector 'darknet': --{} is not given; it needs --model CFG and --weights WEIGHTS",
        options.model.empty() ? "model" : "weights"));
  }
  const Config config = readConfig(options.model, options.score_threshold);
  const cv::Size input =
      options.input_size > 0 ? cv::Size(options.input_size, options.input_size) : config.input;
  return std::make_unique<DarknetDetector>(loadNet(config, options), input, options);
}

}  // namespace hmcdyn::slam

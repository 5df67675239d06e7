// SPDX-License-Identifier: BSD-3-Clause
#include "slam/detect/detector_factory.hpp"

#include <array>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "slam/detect/box_selection.hpp"
#include "slam/detect/coco_classes.hpp"
#include "slam/detect/command_detector.hpp"
#include "slam/detect/darknet_detector.hpp"
#include "slam/detect/file_detector.hpp"
#include "slam/detect/hog_detector.hpp"
#include "slam/detect/onnx_detector.hpp"

namespace hmcdyn::slam {
namespace {

/// Looks at no image: there is no detector, or regions come from masks (MaskFolder).
class NoDetector final : public ObjectDetector {
 public:
  explicit NoDetector(const char* name) : name_(name) {}
  std::vector<DetectionBox> detect(const cv::Mat& bgr, double /*timestamp*/) override {
    checkColorImage(bgr);
    return {};
  }
  std::string name() const override { return name_; }

 private:
  const char* name_;
};

struct DetectorType {
  const char* name;
  std::unique_ptr<ObjectDetector> (*make)(const DetectorOptions&);
};

constexpr std::array<DetectorType, 7> kTypes{{
    {"darknet", makeDarknetDetector},
    {"yolo", makeOnnxDetector},
    {"file", makeFileDetector},
    {"command", makeCommandDetector},
    {"hog", makeHogDetector},
    {"masks",
     [](const DetectorOptions& options) -> std::unique_ptr<ObjectDetector> {
       if (options.masks.empty()) {
         throw std::invalid_argument(
             "detector 'masks': --masks is not given; it needs --masks FOLDER");
       }
       return std::make_unique<NoDetector>("masks");
     }},
    {"none",
     [](const DetectorOptions&) -> std::unique_ptr<ObjectDetector> {
       return std::make_unique<NoDetector>("none");
     }},
}};

void requireShare(const char* option, float value) {
  if (!(value >= 0.0f && value <= 1.0f)) {
    throw std::invalid_argument(
        fmt::format("DetectorOptions::{} is {}; expected 0..1", option, value));
  }
}

void checkCommand(const DetectorOptions& options) {
  if (!options.command.line.empty() && options.type != "command") {
    throw std::invalid_argument(fmt::format(
        "--command is given, but the detector is '{}'; expected --detector command", options.type));
  }
  for (const auto& [name, seconds] : {std::pair("timeout", options.command.timeout),
                                      std::pair("start_timeout", options.command.start_timeout)}) {
    constexpr double kLongest = 1e6;
    if (!(seconds > 0.0 && seconds <= kLongest)) {
      throw std::invalid_argument(fmt::format(
          "CommandOptions::{} is {} s; expected more than 0, up to {}", name, seconds, kLongest));
    }
  }
  if (options.command.restarts < 0) {
    throw std::invalid_argument(fmt::format("CommandOptions::restarts is {}; expected 0 or more",
                                            options.command.restarts));
  }
}

void checkOptions(const DetectorOptions& options) {
  requireShare("score_threshold", options.score_threshold);
  requireShare("nms_threshold", options.nms_threshold);
  constexpr int kLargestInput = 4096;
  if (options.input_size < 0 || options.input_size > kLargestInput ||
      options.input_size % 32 != 0) {
    throw std::invalid_argument(
        fmt::format("DetectorOptions::input_size is {}; expected 0 or a multiple of 32 up to {}",
                    options.input_size, kLargestInput));
  }
  if (!(options.time_tolerance >= 0.0)) {
    throw std::invalid_argument(fmt::format(
        "DetectorOptions::time_tolerance is {} s; expected 0 or more", options.time_tolerance));
  }
  if (options.mask_margin < 0) {
    throw std::invalid_argument(fmt::format(
        "DetectorOptions::mask_margin is {} px; expected 0 or more", options.mask_margin));
  }
  checkCommand(options);
  if (!options.masks.empty() && options.type != "masks") {
    throw std::invalid_argument(fmt::format(
        "--masks is given, but the detector is '{}'; expected --detector masks", options.type));
  }
  for (const int class_id : options.classes) {
    if (class_id < 0 || class_id >= kCocoClassCount) {
      throw std::invalid_argument(
          fmt::format("DetectorOptions::classes has {}; expected COCO classes 0..{}", class_id,
                      kCocoClassCount - 1));
    }
  }
}

}  // namespace

std::vector<std::string> detectorTypes() {
  std::vector<std::string> names;
  names.reserve(kTypes.size());
  for (const DetectorType& type : kTypes) {
    names.emplace_back(type.name);
  }
  return names;
}

std::string describeFormerType(const std::string& type) {
  return type == "motion" ? "detector 'motion' is gone; expected --detector none --filter robust, "
                            "which finds what moves by a motion mask"
                          : "";
}

std::unique_ptr<ObjectDetector> makeDetector(const DetectorOptions& options) {
  checkOptions(options);
  for (const DetectorType& type : kTypes) {
    if (options.type == type.name) {
      return type.make(options);
    }
  }
  const std::string former = describeFormerType(options.type);
  throw std::invalid_argument(former.empty()
                                  ? fmt::format("detector '{}' is unknown; expected one of {}",
                                                options.type, fmt::join(detectorTypes(), ", "))
                                  : former);
}

}  // namespace hmcdyn::slam

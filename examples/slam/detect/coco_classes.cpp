// SPDX-License-Identifier: BSD-3-Clause
#include "slam/detect/coco_classes.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace hmcdyn::slam {
namespace {

constexpr std::array<std::string_view, kCocoClassCount> kNames{
    "person",        "bicycle",      "car",
    "motorcycle",    "airplane",     "bus",
    "train",         "truck",        "boat",
    "traffic light", "fire hydrant", "stop sign",
    "parking meter", "bench",        "bird",
    "cat",           "dog",          "horse",
    "sheep",         "cow",          "elephant",
    "bear",          "zebra",        "giraffe",
    "backpack",      "umbrella",     "handbag",
    "tie",           "suitcase",     "frisbee",
    "skis",          "snowboard",    "sports ball",
    "kite",          "baseball bat", "baseball glove",
    "skateboard",    "surfboard",    "tennis racket",
    "bottle",        "wine glass",   "cup",
    "fork",          "knife",        "spoon",
    "bowl",          "banana",       "apple",
    "sandwich",      "orange",       "broccoli",
    "carrot",        "hot dog",      "pizza",
    "donut",         "cake",         "chair",
    "couch",         "potted plant", "bed",
    "dining table",  "toilet",       "tv",
    "laptop",        "mouse",        "remote",
    "keyboard",      "cell phone",   "microwave",
    "oven",          "toaster",      "sink",
    "refrigerator",  "book",         "clock",
    "vase",          "scissors",     "teddy bear",
    "hair drier",    "toothbrush"};

constexpr std::array<std::pair<std::string_view, std::string_view>, 6> kDarknetSpellings{{
    {"motorbike", "motorcycle"},
    {"aeroplane", "airplane"},
    {"sofa", "couch"},
    {"pottedplant", "potted plant"},
    {"diningtable", "dining table"},
    {"tvmonitor", "tv"},
}};

/// In lower case, without quotes and a colon around, blanks for '_' and '-'.
std::string plainSpelling(const std::string& name) {
  constexpr const char* kAround = "\"':";
  const std::size_t begin = std::min(name.find_first_not_of(kAround), name.size());
  const std::size_t end = name.find_last_not_of(kAround) + 1;
  std::string plain = begin < end ? name.substr(begin, end - begin) : std::string();
  std::transform(plain.begin(), plain.end(), plain.begin(), [](unsigned char c) {
    return c == '_' || c == '-' ? ' ' : static_cast<char>(std::tolower(c));
  });
  return plain;
}

}  // namespace

std::string cocoClassName(int class_id) {
  if (class_id < 0 || class_id >= kCocoClassCount) {
    throw std::invalid_argument(fmt::format("cocoClassName: class_id is {}; expected 0..{}",
                                            class_id, kCocoClassCount - 1));
  }
  return std::string(kNames[static_cast<std::size_t>(class_id)]);
}

std::optional<int> findCocoClass(const std::string& name) {
  std::string wanted = plainSpelling(name);
  for (const auto& [darknet, coco] : kDarknetSpellings) {
    if (wanted == darknet) {
      wanted = coco;
    }
  }
  const auto* const found = std::find(kNames.begin(), kNames.end(), wanted);
  if (found == kNames.end()) {
    return std::nullopt;
  }
  return static_cast<int>(found - kNames.begin());
}

}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#include "slam/detect/command_detector.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <optional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include <hmcdyn/label_image.hpp>
#include <hmcdyn/steps/box_carrier.hpp>

#include "slam/detect/box_selection.hpp"
#include "slam/detect/child_process.hpp"
#include "slam/detect/coco_classes.hpp"
#include "slam/input/dataset/image_file.hpp"
#include "support/text_table.hpp"

namespace hmcdyn::slam {
namespace {

constexpr int kProtocol = 1;
constexpr std::size_t kLongestLine = 16U << 20U;   // some 100 000 boxes
constexpr std::size_t kLargestMask = 256U << 20U;  // bytes of a PNG

ChildProcess::Clock::time_point after(double seconds) {
  return ChildProcess::Clock::now() + std::chrono::duration_cast<ChildProcess::Clock::duration>(
                                          std::chrono::duration<double>(seconds));
}

/// The beginning of a line, fit to be shown.
std::string excerpt(const std::string& line) {
  constexpr std::size_t kShown = 80;
  return "'" + support::printable(std::string_view(line).substr(0, kShown)) +
         (line.size() > kShown ? "...'" : "'");
}

nlohmann::json parseObject(const std::string& line, const char* expected) {
  nlohmann::json json = nlohmann::json::parse(line, nullptr, false);
  if (!json.is_object()) {
    throw std::runtime_error(fmt::format("it wrote {}; expected {}", excerpt(line), expected));
  }
  return json;
}

int classOf(const nlohmann::json& value) {
  if (value.is_string()) {
    if (const std::optional<int> id = findCocoClass(value.get<std::string>())) {
      return *id;
    }
  } else if (value.is_number() && value.get<double>() >= 0.0 &&
             value.get<double>() < kCocoClassCount &&
             value.get<double>() == std::floor(value.get<double>())) {
    return value.get<int>();
  }
  throw std::runtime_error(
      fmt::format("it answered with a box of class {}; expected 0..{} or the "
                  "name of a COCO class",
                  value.dump(), kCocoClassCount - 1));
}

DetectionBox boxOf(const nlohmann::json& row) {
  constexpr std::size_t kNumbers = 5;  // x_min y_min x_max y_max score
  std::array<float, kNumbers> numbers{};
  bool good = row.is_array() && row.size() == kNumbers + 1;
  for (std::size_t i = 0; good && i < kNumbers; ++i) {
    good = row[i].is_number() && std::isfinite(row[i].get<float>());
    numbers[i] = good ? row[i].get<float>() : 0.0f;
  }
  if (!good || numbers[4] < 0.0f || numbers[4] > 1.0f) {
    throw std::runtime_error(
        fmt::format("it answered with the box {}; expected [x_min, y_min, "
                    "x_max, y_max, score 0..1, class]",
                    excerpt(row.dump())));
  }
  return {numbers[0], numbers[1], numbers[2], numbers[3], classOf(row[kNumbers]), numbers[4]};
}

cv::Mat checkedMask(cv::Mat mask, cv::Size size, const std::string& name) {
  if (mask.size() != size || (mask.type() != CV_8UC1 && mask.type() != CV_16UC1)) {
    throw std::runtime_error(fmt::format(
        "its mask {} is {} x {} px, {}; expected {} x {} px, 8 or 16 bit, one channel", name,
        mask.cols, mask.rows, mask.empty() ? "no image" : cv::typeToString(mask.type()), size.width,
        size.height));
  }
  return mask;
}

class CommandDetector final : public ObjectDetector {
 public:
  explicit CommandDetector(DetectorOptions options) : options_(std::move(options)) { begin(); }

  std::vector<DetectionBox> detect(const cv::Mat& bgr, double timestamp) override {
    return see(bgr, timestamp).boxes;
  }

  Seen see(const cv::Mat& bgr, double timestamp) override {
    checkColorImage(bgr);
    if (!process_) {
      startAgain();
    }
    try {
      return ask(bgr, timestamp);
    } catch (const std::exception& error) {
      fail(error.what());
    }
  }

  std::string name() const override {
    return fmt::format("command '{}'{}", options_.command.line,
                       version_.empty() ? "" : fmt::format(" ({})", version_));
  }

 private:
  void begin() {
    process_ = std::make_unique<ChildProcess>(options_.command.line);
    try {
      const std::string line =
          process_->readLine(after(options_.command.start_timeout), kLongestLine);
      const nlohmann::json json =
          parseObject(line, R"({"hmcdyn_detector": 1, "version": "..."} as its first line)");
      if (json.value("hmcdyn_detector", nlohmann::json()) != kProtocol) {
        throw std::runtime_error(fmt::format(R"(it wrote {}; expected "hmcdyn_detector": {})",
                                             excerpt(line), kProtocol));
      }
      const nlohmann::json version = json.value("version", nlohmann::json(""));
      version_ =
          support::printable(version.is_string() ? version.get<std::string>() : version.dump());
    } catch (const std::exception& error) {
      fail(error.what());
    }
  }

  void startAgain() {
    if (restarts_ >= options_.command.restarts) {
      throw std::runtime_error(fmt::format(
          "it was started {} times again (--command-restarts) and is given up", restarts_));
    }
    ++restarts_;
    begin();
  }

  /// Ends the process; says why, and what it wrote to its standard error.
  [[noreturn]] void fail(const std::string& why) {
    process_->kill();
    std::string words = process_->lastWords();
    process_.reset();
    while (!words.empty() && (words.back() == '\n' || words.back() == ' ')) {
      words.pop_back();
    }
    throw std::runtime_error(fmt::format("command '{}': {}{}", options_.command.line, why,
                                         words.empty()
                                             ? "; it wrote nothing to its standard error"
                                             : "; the end of its standard error:\n" + words));
  }

  Seen ask(const cv::Mat& bgr, double timestamp) {
    const auto deadline = after(options_.command.timeout);
    const std::size_t frame = ++frame_;
    const cv::Mat image = bgr.isContinuous() ? bgr : bgr.clone();
    const std::size_t bytes = image.total() * image.elemSize();
    const std::string header =
        fmt::format(R"({{"frame": {}, "timestamp": {}, "width": {}, "height": {}, "bytes": {}}})"
                    "\n",
                    frame, timestamp, image.cols, image.rows, bytes);
    process_->write(header, deadline);
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): pixels as bytes
    process_->write({reinterpret_cast<const char*>(image.data), bytes}, deadline);
    const CommandAnswer answer =
        parseCommandAnswer(process_->readLine(deadline, kLongestLine), frame);
    Seen seen;
    seen.labels = maskOf(answer, bgr.size(), deadline);
    const std::vector<DetectionBox> boxes =
        seen.labels.empty() ? keepWanted(answer.boxes, options_)
                            : boundingBoxes(seen.labels, regionsIn(seen.labels));
    seen.boxes = clipToImage(boxes, bgr.size());
    std::stable_sort(
        seen.boxes.begin(), seen.boxes.end(),
        [](const DetectionBox& a, const DetectionBox& b) { return a.score > b.score; });
    return seen;
  }

  cv::Mat maskOf(const CommandAnswer& answer, cv::Size size,
                 ChildProcess::Clock::time_point deadline) {
    if (!answer.mask_file.empty()) {
      return checkedMask(readImage(answer.mask_file), size, answer.mask_file);
    }
    if (answer.mask_bytes == 0) {
      return {};
    }
    const std::string png = process_->read(answer.mask_bytes, deadline);
    const std::vector<char> buffer(png.begin(), png.end());
    return checkedMask(cv::imdecode(buffer, cv::IMREAD_UNCHANGED), size,
                       fmt::format("of {} bytes", png.size()));
  }

  DetectorOptions options_;
  std::unique_ptr<ChildProcess> process_;  ///< Null after it failed.
  std::string version_;
  std::size_t frame_ = 0;  ///< Of the last question, from 1.
  int restarts_ = 0;
};

}  // namespace

CommandAnswer parseCommandAnswer(const std::string& line, std::size_t frame) {
  const nlohmann::json json =
      parseObject(line, R"(a line of JSON such as {"frame": 1, "boxes": []})");
  if (json.contains("error")) {
    throw std::runtime_error("it says: " + support::printable(json["error"].dump()));
  }
  if (json.value("frame", nlohmann::json()) != frame) {
    throw std::runtime_error(
        fmt::format("it answered {}; expected an answer to frame {}", excerpt(line), frame));
  }
  CommandAnswer answer;
  if (json.contains("mask")) {
    if (!json["mask"].is_string() || json["mask"].get<std::string>().empty()) {
      throw std::runtime_error(
          fmt::format("it answered {}; expected \"mask\" to be the path of a "
                      "PNG",
                      excerpt(line)));
    }
    answer.mask_file = json["mask"].get<std::string>();
  } else if (json.contains("mask_bytes")) {
    const nlohmann::json& bytes = json["mask_bytes"];
    if (!bytes.is_number_unsigned() || bytes == 0 || bytes > kLargestMask) {
      throw std::runtime_error(fmt::format("it answered {}; expected \"mask_bytes\" to be 1 to {}",
                                           excerpt(line), kLargestMask));
    }
    answer.mask_bytes = bytes.get<std::size_t>();
  } else if (!json.contains("boxes") || !json["boxes"].is_array()) {
    throw std::runtime_error(fmt::format(
        R"(it answered {}; expected "boxes", "mask", "mask_bytes" or "error")", excerpt(line)));
  } else {
    for (const nlohmann::json& row : json["boxes"]) {
      answer.boxes.push_back(boxOf(row));
    }
  }
  return answer;
}

std::unique_ptr<ObjectDetector> makeCommandDetector(const DetectorOptions& options) {
  if (options.command.line.empty()) {
    throw std::invalid_argument(
        "detector 'command': --command is not given; it needs --command 'PROGRAM ARGUMENTS'");
  }
  return std::make_unique<CommandDetector>(options);
}

}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#include "slam/detect/file_detector.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "slam/detect/box_selection.hpp"
#include "slam/detect/coco_classes.hpp"
#include "slam/input/dataset/file_io.hpp"
#include "support/file_kind.hpp"
#include "support/text_table.hpp"
#include "support/time_stamps.hpp"

namespace hmcdyn::slam {
namespace {

constexpr std::size_t kNumbersBehindClass = 5;  // x_min y_min x_max y_max score
constexpr std::size_t kLeastFields = 2 + kNumbersBehindClass;

bool isNumber(const std::string& field) {
  double ignored = 0.0;
  return support::parseNumber(field, ignored);
}

/// Pedestrian 0.00 0 -0.20 x_min y_min x_max y_max height width length x y z turn, and a score.
bool isKittiLabel(const support::TextRow& row) {
  constexpr std::size_t kFields = 15;
  return (row.fields.size() == kFields || row.fields.size() == kFields + 1) &&
         !isNumber(row.fields.front()) &&
         std::all_of(row.fields.begin() + 1, row.fields.end(), isNumber);
}

// What a row that is no box may be.
std::string guessOfRow(const support::TextRow& row) {
  if (std::string markup = support::guessOfMarkup(row.fields.front()); !markup.empty()) {
    return markup;
  }
  if (isKittiLabel(row)) {
    return "; is this KITTI's file of one image? Write all images into one file, with time stamp, "
           "class, corners and score";
  }
  if (!std::all_of(row.fields.begin(), row.fields.end(), isNumber)) {
    if (row.fields.size() == kLeastFields + 1 && !isNumber(row.fields.back()) &&
        std::all_of(row.fields.begin(), row.fields.end() - 1, isNumber)) {
      return "; is this a detector's \"image x_min y_min x_max y_max score class name\"? Write the "
             "time stamp of the image, and the class behind it";
    }
    return row.fields.size() + 1 == kLeastFields && isNumber(row.fields.front())
               ? "; is the score missing? Write 1 behind each line"
               : "";
  }
  switch (row.fields.size()) {
    case 5:
      return "; is this \"class x y width height\" or \"x y width height score\", YOLO's file of "
             "one "
             "image? Write all images into one file, with time stamp, class, corners in pixels and "
             "score";
    case 6:
      return "; is the class missing (\"timestamp x y width height score\")? Write it behind the "
             "time stamp, and corners in place of width and height; or is this YOLO's \"class x y "
             "width height score\" of one image? Then the time stamp is missing, too";
    case 9:
    case 10:
      return "; is this the MOT challenge's \"frame id x y width height ...\"? Convert it";
    default:
      return support::guessOfFields(row, kLeastFields);
  }
}

// Names such as "traffic light" spread over two fields; a number may be written as 0.0.
int parseClass(const support::TextRow& row, const std::filesystem::path& file) {
  const auto end = row.fields.end() - kNumbersBehindClass;
  const std::string text = fmt::format("{}", fmt::join(row.fields.begin() + 1, end, " "));
  if (const auto class_id = findCocoClass(text)) {
    return *class_id;
  }
  double number = 0.0;
  if (support::parseNumber(text, number) && number >= 0.0 && number < kCocoClassCount &&
      number == std::floor(number)) {
    return static_cast<int>(number);
  }
  throw errorAt(file, row.line,
                fmt::format("class is '{}'; expected 0..{} or the name of a COCO class{}",
                            support::printable(text), kCocoClassCount - 1, guessOfRow(row)));
}

std::runtime_error wrongFields(const support::TextRow& row, const std::filesystem::path& file) {
  // A file that holds JSON is rather shown by its first field than by their number.
  return errorAt(
      file, row.line,
      fmt::format("{} fields, the first '{}'; expected \"timestamp class x_min y_min "
                  "x_max y_max score\"{}",
                  row.fields.size(), support::printable(row.fields.front()), guessOfRow(row)));
}

/// What the number in the place of a score may be, to end a message with.
std::string guessOfScore(const DetectionBox& box) {
  const bool is_share = box.x_min >= 0.0f && box.x_min <= 1.0f;
  if (is_share && box.score > 1.0f && box.score > box.x_max) {
    return fmt::format("; does the score, {:g}, stand before the corners? It comes last",
                       box.x_min);
  }
  return box.score > 1.0f && box.score <= 100.0f
             ? "; is it per cent, or a width in the place of the score?"
             : "";
}

TimedBox parseRow(const support::TextRow& row, const std::filesystem::path& file) {
  if (row.fields.size() < kLeastFields) {
    throw wrongFields(row, file);
  }
  if (row.fields.size() == kLeastFields && isNumber(row.fields[1]) &&
      !isNumber(row.fields.back()) && findCocoClass(row.fields.back())) {
    throw errorAt(file, row.line,
                  fmt::format("the class, '{}', is behind the score; expected it behind the time "
                              "stamp",
                              support::printable(row.fields.back())));
  }
  const std::size_t first = row.fields.size() - kNumbersBehindClass;
  // A class's name has no number among its words.
  if (isKittiLabel(row) ||
      (first > 2 && std::any_of(row.fields.begin() + 1, row.fields.begin() + first, isNumber))) {
    throw wrongFields(row, file);
  }
  const auto number = [&](std::size_t i, const char* what) {
    return static_cast<float>(parseFinite(row.fields[first + i], what, file, row.line));
  };
  TimedBox timed;
  timed.timestamp = support::parseStamp(row.fields.front(), "timestamp", file.string(), row.line);
  timed.box.class_id = parseClass(row, file);
  timed.box.x_min = number(0, "x_min");
  timed.box.y_min = number(1, "y_min");
  timed.box.x_max = number(2, "x_max");
  timed.box.y_max = number(3, "y_max");
  timed.box.score = number(4, "score");
  if (timed.box.score < 0.0f || timed.box.score > 1.0f) {
    throw errorAt(
        file, row.line,
        fmt::format("score is {}; expected 0..1{}", timed.box.score, guessOfScore(timed.box)));
  }
  return timed;
}

support::TextTable tableOf(const std::filesystem::path& file) {
  return support::readTable(file, [](std::size_t fields) { return fields >= kLeastFields; });
}

std::vector<TimedBox> boxesOf(const support::TextTable& table, const std::filesystem::path& file) {
  std::vector<TimedBox> boxes;
  for (const support::TextRow& row : table.rows) {
    boxes.push_back(parseRow(row, file));
  }
  std::stable_sort(boxes.begin(), boxes.end(), [](const TimedBox& left, const TimedBox& right) {
    return left.timestamp < right.timestamp;
  });
  return boxes;
}

class FileDetector final : public ObjectDetector {
 public:
  FileDetector(std::vector<TimedBox> boxes, DetectorOptions options)
      : boxes_(std::move(boxes)), options_(std::move(options)) {}

  std::vector<DetectionBox> detect(const cv::Mat& bgr, double timestamp) override {
    checkColorImage(bgr);
    std::vector<DetectionBox> boxes;
    const auto [first, last] = nearest(timestamp);
    for (auto timed = first; timed != last; ++timed) {
      boxes.push_back(timed->box);
    }
    std::vector<DetectionBox> kept = clipToImage(boxes, bgr.size());
    std::stable_sort(kept.begin(), kept.end(), [](const DetectionBox& a, const DetectionBox& b) {
      return a.score > b.score;
    });
    return kept;
  }

  std::string name() const override {
    return fmt::format("file {}", options_.boxes.filename().string());
  }

 private:
  using Iterator = std::vector<TimedBox>::const_iterator;

  // The boxes of the time stamp nearest to this one, none where it is too far; of two equally
  // near, the earlier.
  std::pair<Iterator, Iterator> nearest(double timestamp) const {
    const auto earlier = [](const TimedBox& timed, double time) { return timed.timestamp < time; };
    auto candidate = std::lower_bound(boxes_.begin(), boxes_.end(), timestamp, earlier);
    if (candidate != boxes_.begin() &&
        (candidate == boxes_.end() ||
         timestamp - std::prev(candidate)->timestamp <= candidate->timestamp - timestamp)) {
      --candidate;
    }
    if (candidate == boxes_.end() ||
        !(std::abs(candidate->timestamp - timestamp) <= options_.time_tolerance)) {
      return {boxes_.end(), boxes_.end()};
    }
    const double time = candidate->timestamp;
    const auto first = std::lower_bound(boxes_.begin(), boxes_.end(), time, earlier);
    const auto last = std::find_if(
        first, boxes_.end(), [time](const TimedBox& timed) { return timed.timestamp != time; });
    return {first, last};
  }

  std::vector<TimedBox> boxes_;
  DetectorOptions options_;
};

}  // namespace

std::vector<TimedBox> readBoxFile(const std::filesystem::path& file) {
  return boxesOf(tableOf(file), file);
}

BoxReview reviewBoxFile(const std::filesystem::path& file, const DetectorOptions& options) {
  const support::TextTable table = tableOf(file);
  BoxReview review = reviewBoxes(boxesOf(table, file), options, file);
  review.notes.insert(review.notes.begin(), table.notes.begin(), table.notes.end());
  return review;
}

std::unique_ptr<ObjectDetector> makeFileDetector(const DetectorOptions& options) {
  if (options.boxes.empty()) {
    throw std::invalid_argument("detector 'file': --boxes is not given; it needs --boxes FILE");
  }
  BoxReview review = reviewBoxFile(options.boxes, options);
  return std::make_unique<FileDetector>(std::move(review.kept), options);
}

}  // namespace hmcdyn::slam

// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/label_score.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <sstream>
#include <stdexcept>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace hmcdyn::evaluate {
namespace {

constexpr int kStatic = 0;
constexpr int kStanding = 128;
constexpr int kMoving = 255;

double ratio(std::size_t part, std::size_t whole) {
  return whole == 0 ? std::numeric_limits<double>::quiet_NaN()
                    : static_cast<double>(part) / static_cast<double>(whole);
}

[[noreturn]] void fail(const std::filesystem::path& file, std::size_t line,
                       const std::string& what) {
  throw std::runtime_error(file.string() + ":" + std::to_string(line) + ": " + what);
}

double parseNumber(const std::string& text, const std::filesystem::path& file, std::size_t line) {
  std::size_t used = 0;
  double value = 0.0;
  try {
    value = std::stod(text, &used);
  } catch (const std::exception&) {
    used = 0;
  }
  if (used != text.size() || text.empty() || !std::isfinite(value)) {
    fail(file, line, "expected a finite number, found '" + text + "'");
  }
  return value;
}

std::ifstream open(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) {
    throw std::runtime_error(file.string() + ": cannot be read");
  }
  return stream;
}

using BoxesByTime = std::map<std::string, std::vector<ScoreBox>>;

BoxesByTime readBoxes(const std::filesystem::path& file) {
  std::ifstream stream = open(file);
  BoxesByTime boxes;
  std::string text;
  for (std::size_t line = 1; std::getline(stream, text); ++line) {
    if (text.empty() || text.front() == '#') {
      continue;
    }
    std::istringstream fields(text);
    std::string timestamp;
    std::string object_class;
    std::array<std::string, 4> corner;
    if (!(fields >> timestamp >> object_class >> corner[0] >> corner[1] >> corner[2] >>
          corner[3])) {
      fail(file, line, "expected 'timestamp class x_min y_min x_max y_max score'");
    }
    boxes[timestamp].push_back(
        {parseNumber(corner[0], file, line), parseNumber(corner[1], file, line),
         parseNumber(corner[2], file, line), parseNumber(corner[3], file, line)});
  }
  return boxes;
}

/// The mask's value at a point; nothing (-1) within `margin` of another value.
int maskAt(const cv::Mat& mask, double u, double v, int margin) {
  const int column = std::clamp(cvRound(u), 0, mask.cols - 1);
  const int row = std::clamp(cvRound(v), 0, mask.rows - 1);
  const int value = mask.at<std::uint8_t>(row, column);
  for (int r = std::max(0, row - margin); r <= std::min(mask.rows - 1, row + margin); ++r) {
    for (int c = std::max(0, column - margin); c <= std::min(mask.cols - 1, column + margin); ++c) {
      if (mask.at<std::uint8_t>(r, c) != value) {
        return -1;
      }
    }
  }
  return value;
}

bool insideAny(const std::vector<ScoreBox>& boxes, const LabelledPoint& point) {
  return std::any_of(boxes.begin(), boxes.end(), [&](const ScoreBox& box) {
    return point.u >= box.x_min && point.u <= box.x_max && point.v >= box.y_min &&
           point.v <= box.y_max;
  });
}

void count(const LabelledPoint& point, int truth, bool in_box, LabelScore& score) {
  const bool called_dynamic = point.label == "dynamic";
  if (truth == kMoving) {
    ++(called_dynamic ? score.true_dynamic : score.missed_dynamic);
  } else if (truth == kStatic) {
    ++(called_dynamic ? score.false_dynamic : score.true_static);
    score.static_in_boxes += in_box ? 1 : 0;
    score.kept_in_boxes += in_box && !called_dynamic ? 1 : 0;
  } else if (truth == kStanding) {
    ++score.standing;
  } else {
    ++score.on_border;
  }
}

}  // namespace

double LabelScore::precision() const { return ratio(true_dynamic, true_dynamic + false_dynamic); }
double LabelScore::recall() const { return ratio(true_dynamic, true_dynamic + missed_dynamic); }
double LabelScore::f1() const {
  return ratio(2 * true_dynamic, 2 * true_dynamic + false_dynamic + missed_dynamic);
}
double LabelScore::keptShare() const { return ratio(kept_in_boxes, static_in_boxes); }

std::vector<LabelledPoint> readLabelledPoints(const std::filesystem::path& file) {
  std::ifstream stream = open(file);
  const std::string kHeader = "timestamp,u,v,depth,distance,cluster,label,weight";
  const std::string kHeaderWithSize = kHeader + ",size";
  std::string text;
  if (!std::getline(stream, text) || (text != kHeader && text != kHeaderWithSize)) {
    fail(file, 1, "expected the header '" + kHeaderWithSize + "'");
  }
  const std::size_t columns = text == kHeader ? 8 : 9;
  std::vector<LabelledPoint> points;
  for (std::size_t line = 2; std::getline(stream, text); ++line) {
    std::vector<std::string> fields;
    std::istringstream row(text);
    for (std::string field; std::getline(row, field, ',');) {
      fields.push_back(field);
    }
    if (fields.size() != columns) {
      fail(file, line,
           "expected " + std::to_string(columns) + " fields, found " +
               std::to_string(fields.size()));
    }
    constexpr double kPatch = 31.0;  // diameter of ORB's patch at the finest level (px)
    points.push_back({fields[0], parseNumber(fields[1], file, line),
                      parseNumber(fields[2], file, line), fields[6],
                      columns == 9 ? parseNumber(fields[8], file, line) / kPatch : 1.0});
  }
  return points;
}

LabelScore scoreLabels(const std::vector<LabelledPoint>& points,
                       const std::filesystem::path& sequence, const LabelScoreOptions& options) {
  const BoxesByTime boxes = readBoxes(sequence / "boxes.txt");
  LabelScore score;
  std::string timestamp;
  std::size_t frame = 0;
  cv::Mat mask;
  const std::vector<ScoreBox>* frame_boxes = nullptr;
  const std::vector<ScoreBox> no_boxes;
  for (const LabelledPoint& point : points) {
    if (point.timestamp != timestamp) {
      timestamp = point.timestamp;
      ++frame;
      mask = cv::imread((sequence / "mask" / (timestamp + ".png")).string(), cv::IMREAD_GRAYSCALE);
      const auto found = boxes.find(timestamp);
      frame_boxes = found == boxes.end() ? &no_boxes : &found->second;
    }
    if (frame <= options.skip_frames) {
      continue;
    }
    if (mask.empty()) {
      ++score.without_mask;
      continue;
    }
    constexpr double kFastRadius = 3.0;  // px
    const int margin = options.margin.value_or(
        static_cast<int>(std::ceil(kFastRadius * std::max(point.scale, 1.0))));
    count(point, maskAt(mask, point.u, point.v, margin), insideAny(*frame_boxes, point), score);
  }
  if (score.without_mask == points.size() && !points.empty()) {
    throw std::runtime_error((sequence / "mask").string() + ": no mask for any time stamp");
  }
  return score;
}

}  // namespace hmcdyn::evaluate

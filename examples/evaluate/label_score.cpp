// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/label_score.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "support/text_table.hpp"

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
  double value = 0.0;
  if (!support::parseNumber(text, value) || !std::isfinite(value)) {
    fail(file, line, "expected a finite number, found '" + support::printable(text) + "'");
  }
  return value;
}

/// The lines of a text file without blanks at their ends.
std::vector<std::string> readLines(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) {
    throw std::runtime_error(file.string() + ": cannot be read");
  }
  std::istringstream text(support::toText(support::readBytes(file), file.string()));
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) {
    line.erase(line.find_last_not_of(" \t\r") + 1);
    lines.push_back(std::move(line));
  }
  return lines;
}

using BoxesByTime = std::map<std::string, std::vector<ScoreBox>>;

BoxesByTime readBoxes(const std::filesystem::path& file) {
  BoxesByTime boxes;
  constexpr std::size_t kFields = 6;  // and a score, which plays no part
  const support::TextTable table =
      support::readTable(file, [](std::size_t fields) { return fields >= kFields; });
  for (const support::TextRow& row : table.rows) {
    const std::vector<std::string>& fields = row.fields;
    if (fields.size() < kFields) {
      fail(file, row.line, "expected 'timestamp class x_min y_min x_max y_max score'");
    }
    boxes[fields[0]].push_back(
        {parseNumber(fields[2], file, row.line), parseNumber(fields[3], file, row.line),
         parseNumber(fields[4], file, row.line), parseNumber(fields[5], file, row.line)});
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
  const std::vector<std::string> lines = readLines(file);
  const std::string kHeader = "timestamp,u,v,depth,distance,cluster,label,weight";
  const std::string kHeaderWithSize = kHeader + ",size";
  if (lines.empty() || (lines.front() != kHeader && lines.front() != kHeaderWithSize)) {
    fail(file, 1, "expected the header '" + kHeaderWithSize + "'");
  }
  const std::size_t columns = lines.front() == kHeader ? 8 : 9;
  std::vector<LabelledPoint> points;
  for (std::size_t line = 2; line <= lines.size(); ++line) {
    if (lines[line - 1].empty()) {
      continue;
    }
    std::vector<std::string> fields;
    std::istringstream row(lines[line - 1]);
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

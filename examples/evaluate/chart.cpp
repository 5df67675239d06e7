// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/chart.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "evaluate/statistics.hpp"

namespace hmcdyn::evaluate {
namespace {

constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr double kFontScale = 0.5;
constexpr int kSubPixelBits = 4;

const cv::Scalar kBlack(0, 0, 0);
const cv::Scalar kGrid(225, 225, 225);

/// Part of the picture that shows a range of values.
struct Panel {
  cv::Rect2d pixels;
  cv::Rect2d values;

  cv::Point2d toPixel(const cv::Point2d& value) const {
    return {pixels.x + (value.x - values.x) / values.width * pixels.width,
            pixels.y + pixels.height - (value.y - values.y) / values.height * pixels.height};
  }
};

cv::Point fixedPoint(const cv::Point2d& pixel) {
  constexpr double kFactor = 1 << kSubPixelBits;
  return {cvRound(pixel.x * kFactor), cvRound(pixel.y * kFactor)};
}

/// The step of the form 1, 2 or 5 times a power of ten that gives about `count` ticks.
double tickStep(double range, int count) {
  const double raw = range / count;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= raw) {
      return factor * power;
    }
  }
  return 10.0 * power;
}

std::vector<double> ticks(double low, double range, int count) {
  const double step = tickStep(range, count);
  std::vector<double> values;
  for (double i = std::ceil(low / step - 1e-9); i * step <= low + range * (1.0 + 1e-9); ++i) {
    values.push_back(i * step);
  }
  return values;
}

std::string tickLabel(double value, double range, int count) {
  const int decimals =
      std::max(0, static_cast<int>(-std::floor(std::log10(tickStep(range, count)))));
  const double rounded = std::abs(value) < 1e-9 * range ? 0.0 : value;
  return fmt::format("{:.{}f}", rounded, decimals);
}

cv::Size textSize(const std::string& text) {
  int baseline = 0;
  return cv::getTextSize(text, kFont, kFontScale, 1, &baseline);
}

/// `anchor` says which part of the text lies at the position: 0 = left, 0.5 = middle, 1 = right.
void drawAnchored(cv::Mat& picture, const std::string& text, cv::Point2d position, double anchor) {
  position.x -= anchor * textSize(text).width;
  cv::putText(picture, text, position, kFont, kFontScale, kBlack, 1, cv::LINE_AA);
}

void drawAxes(cv::Mat& picture, const Panel& panel, const std::string& x_label,
              const std::string& y_label) {
  constexpr int kTicks = 8;
  const double bottom = panel.pixels.y + panel.pixels.height;
  for (const double x : ticks(panel.values.x, panel.values.width, kTicks)) {
    const cv::Point2d foot = panel.toPixel({x, panel.values.y});
    cv::line(picture, foot, {cvRound(foot.x), cvRound(panel.pixels.y)}, kGrid);
    drawAnchored(picture, tickLabel(x, panel.values.width, kTicks), {foot.x, bottom + 20.0}, 0.5);
  }
  for (const double y : ticks(panel.values.y, panel.values.height, kTicks)) {
    const cv::Point2d left = panel.toPixel({panel.values.x, y});
    cv::line(picture, left, {cvRound(left.x + panel.pixels.width), cvRound(left.y)}, kGrid);
    drawAnchored(picture, tickLabel(y, panel.values.height, kTicks), {left.x - 8.0, left.y + 5.0},
                 1.0);
  }
  cv::rectangle(picture, cv::Rect(panel.pixels), kBlack);
  drawAnchored(picture, x_label, {panel.pixels.x + 0.5 * panel.pixels.width, bottom + 44.0}, 0.5);
  drawAnchored(picture, y_label, {panel.pixels.x, panel.pixels.y - 10.0}, 0.0);
}

void drawLine(cv::Mat& picture, const Panel& panel, const ChartLine& line) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < line.times.size(); ++i) {
    intervals.push_back(line.times[i] - line.times[i - 1]);
  }
  const double gap = intervals.empty() ? 0.0 : 3.0 * median(intervals);
  for (std::size_t i = 1; i < line.points.size(); ++i) {
    if (line.times[i] - line.times[i - 1] <= gap) {
      cv::line(picture, fixedPoint(panel.toPixel(line.points[i - 1])),
               fixedPoint(panel.toPixel(line.points[i])), line.colour, line.thickness, cv::LINE_AA,
               kSubPixelBits);
    }
  }
}

/// Smallest range that holds all points, grown by a margin; never empty.
cv::Rect2d rangeOf(const std::vector<ChartLine>& lines) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  cv::Point2d low(kInfinity, kInfinity);
  cv::Point2d high(-kInfinity, -kInfinity);
  for (const ChartLine& line : lines) {
    for (const cv::Point2d& point : line.points) {
      low = {std::min(low.x, point.x), std::min(low.y, point.y)};
      high = {std::max(high.x, point.x), std::max(high.y, point.y)};
    }
  }
  constexpr double kMargin = 0.05;
  constexpr double kLeast = 1e-4;
  const cv::Size2d size(std::max(high.x - low.x, kLeast), std::max(high.y - low.y, kLeast));
  return {low.x - kMargin * size.width, low.y - kMargin * size.height,
          (1.0 + 2.0 * kMargin) * size.width, (1.0 + 2.0 * kMargin) * size.height};
}

/// The range grown about its centre until a unit has the same length in both directions.
cv::Rect2d withEqualScales(const cv::Rect2d& range, const cv::Size2d& pixels) {
  const double scale = std::max(range.width / pixels.width, range.height / pixels.height);
  const cv::Size2d size(scale * pixels.width, scale * pixels.height);
  return {range.x - 0.5 * (size.width - range.width), range.y - 0.5 * (size.height - range.height),
          size.width, size.height};
}

}  // namespace

void drawChart(cv::Mat& picture, const cv::Rect& pixels, const Chart& chart) {
  Panel panel{pixels, rangeOf(chart.lines)};
  if (chart.has_equal_scales) {
    panel.values = withEqualScales(panel.values, panel.pixels.size());
  }
  if (chart.starts_at_zero) {
    panel.values.height += panel.values.y;
    panel.values.y = 0.0;
  }
  drawAxes(picture, panel, chart.x_label, chart.y_label);
  for (const ChartLine& line : chart.lines) {
    drawLine(picture, panel, line);
  }
}

int drawText(cv::Mat& picture, const std::string& text, const cv::Point& position) {
  drawAnchored(picture, text, position, 0.0);
  return textSize(text).width;
}

}  // namespace hmcdyn::evaluate

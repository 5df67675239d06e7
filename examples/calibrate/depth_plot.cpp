// SPDX-License-Identifier: BSD-3-Clause
#include "calibrate/depth_plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "evaluate/chart.hpp"

namespace hmcdyn::calibrate {
namespace {

using evaluate::Chart;
using evaluate::ChartLine;

// Okabe and Ito's colours (BGR).
const cv::Scalar kOrange(0, 94, 213);
const cv::Scalar kBlue(178, 114, 0);
const cv::Scalar kGreen(115, 158, 0);

void addPoint(ChartLine& line, double x, double y) {
  line.times.push_back(static_cast<double>(line.times.size()));
  line.points.emplace_back(x, y);
}

template <class Value>
ChartLine rangeLine(const std::vector<RangeStatistics>& ranges, const cv::Scalar& colour,
                    Value value) {
  ChartLine line;
  line.colour = colour;
  line.thickness = 2;
  for (const RangeStatistics& range : ranges) {
    addPoint(line, range.middle, 1e3 * value(range));
  }
  return line;
}

template <class Value>
ChartLine modelLine(const std::vector<RangeStatistics>& ranges, const cv::Scalar& colour,
                    Value value) {
  ChartLine line;
  line.colour = colour;
  for (int i = 0; i <= 50; ++i) {
    const double z =
        ranges.front().middle + i / 50.0 * (ranges.back().middle - ranges.front().middle);
    addPoint(line, z, 1e3 * value(z));
  }
  return line;
}

void drawLegend(cv::Mat& picture, cv::Point place,
                const std::vector<std::pair<std::string, cv::Scalar>>& entries) {
  for (const auto& entry : entries) {
    cv::line(picture, place - cv::Point(0, 5), place + cv::Point(30, -5), entry.second, 3,
             cv::LINE_AA);
    place.x += 68 + evaluate::drawText(picture, entry.first, place + cv::Point(38, 0));
  }
}

void drawBias(cv::Mat& picture, const Calibration& c) {
  const auto bias = [](const RangeStatistics& range) { return range.bias; };
  Chart chart;
  chart.x_label = "depth (m)";
  chart.y_label = "median error (mm)";
  chart.lines.push_back(rangeLine(c.before.ranges, kOrange, bias));
  chart.lines.push_back(rangeLine(c.after.ranges, kBlue, bias));
  drawLegend(picture, {80, 30}, {{"as measured", kOrange}, {"corrected (held out)", kBlue}});
  drawChart(picture, {80, 70, 670, 500}, chart);
}

void drawDeviations(cv::Mat& picture, const Calibration& c) {
  const auto& ranges = c.corrects ? c.after.ranges : c.before.ranges;
  const DepthErrorModel& model = c.corrects ? c.model_after : c.model_before;
  Chart chart;
  chart.x_label = "depth (m)";
  chart.y_label = "standard deviation (mm)";
  chart.starts_at_zero = true;
  chart.lines.push_back(rangeLine(ranges, kGreen, [](const auto& range) { return range.noise; }));
  chart.lines.push_back(
      rangeLine(ranges, kOrange, [](const auto& range) { return range.systematic; }));
  chart.lines.push_back(
      modelLine(ranges, kGreen, [&model](double z) { return depthNoise(z, model); }));
  chart.lines.push_back(
      modelLine(ranges, kOrange, [&model](double z) { return systematicDepthError(z, model); }));
  drawLegend(picture, {880, 30},
             {{"noise", kGreen}, {"systematic", kOrange}, {"thin: the model", cv::Scalar()}});
  drawChart(picture, {880, 70, 670, 500}, chart);
}

/// By how much the correction changes a depth, over the image: blue nearer, red farther.
void drawField(cv::Mat& picture, const Calibration& c, double depth, const cv::Rect& place,
               double largest) {
  cv::Mat change(place.size(), CV_8UC1);
  const cv::Size size = place.size();
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      const double relative = corrected(c.fit.correction, depth, u, v, size) / depth - 1.0;
      change.at<std::uint8_t>(v, u) =
          cv::saturate_cast<std::uint8_t>(127.5 * (1.0 + relative / largest));
    }
  }
  cv::Mat coloured;
  cv::applyColorMap(change, coloured, cv::COLORMAP_JET);
  coloured.copyTo(picture(place));
  evaluate::drawText(picture,
                     fmt::format("correction at {:.0f} m, blue -{:.1f} % to red +{:.1f} %", depth,
                                 100.0 * largest, 100.0 * largest),
                     place.tl() - cv::Point(0, 10));
}

}  // namespace

cv::Mat drawCalibration(const Calibration& calibration) {
  cv::Mat picture(1050, 1600, CV_8UC3, cv::Scalar::all(255));
  drawBias(picture, calibration);
  drawDeviations(picture, calibration);
  double largest = 0.001;
  for (const double growth : calibration.fit.correction.growth) {
    largest = std::max(largest, std::abs(calibration.fit.correction.scale - 1.0 + growth * 3.0));
  }
  for (int i = 0; i < 3; ++i) {
    drawField(picture, calibration, i + 1.0, {80 + i * 510, 680, 440, 330}, largest);
  }
  return picture;
}

}  // namespace hmcdyn::calibrate

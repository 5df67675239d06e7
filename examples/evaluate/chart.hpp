// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace hmcdyn::evaluate {

/// Values (x, y) of a chart with a time each, which tells where the line must break.
struct ChartLine {
  std::vector<double> times;  ///< s, increasing.
  std::vector<cv::Point2d> points;
  cv::Scalar colour;  ///< BGR.
  int thickness = 1;  ///< px.
};

/// A chart's lines and what its axes say.
struct Chart {
  std::vector<ChartLine> lines;   ///< Drawn in this order; at least one with a point.
  std::string x_label;            ///< With the unit.
  std::string y_label;            ///< With the unit.
  bool has_equal_scales = false;  ///< A unit has the same length in both directions, as on a map.
  bool starts_at_zero = false;    ///< The y axis starts at 0.
};

/// Draws a chart with axes, ticks and grid into a part of a picture (8-bit BGR). The labels of the
/// axes stand outside of `pixels`: about 80 px are needed on the left, 50 px below, 30 px above.
/// A line breaks where its time jumps by more than three times its median step.
void drawChart(cv::Mat& picture, const cv::Rect& pixels, const Chart& chart);

/// Writes text in the charts' font, its lower left corner at `position`.
/// @return the width (px).
int drawText(cv::Mat& picture, const std::string& text, const cv::Point& position);

}  // namespace hmcdyn::evaluate

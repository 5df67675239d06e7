// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/plot.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <stdexcept>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "evaluate/chart.hpp"
#include "evaluate/statistics.hpp"

namespace hmcdyn::evaluate {
namespace {

const cv::Scalar kTruthColour(0, 0, 0);

/// Okabe and Ito's colours (BGR), which people with colour-blindness can tell apart.
cv::Scalar systemColour(std::size_t system) {
  static const std::array<cv::Scalar, 7> kColours{
      cv::Scalar(0, 94, 213),    cv::Scalar(178, 114, 0), cv::Scalar(115, 158, 0),
      cv::Scalar(167, 121, 204), cv::Scalar(0, 159, 230), cv::Scalar(233, 180, 86),
      cv::Scalar(66, 228, 240)};
  return kColours.at(system % kColours.size());
}

/// The two axes along which the positions extend most, in their order x, y, z.
std::array<int, 2> widestAxes(const std::vector<Eigen::Vector3d>& positions) {
  Eigen::Array3d low = positions.front();
  Eigen::Array3d high = positions.front();
  for (const Eigen::Vector3d& position : positions) {
    low = low.min(position.array());
    high = high.max(position.array());
  }
  Eigen::Index thinnest = 0;
  (high - low).minCoeff(&thinnest);
  if (thinnest == 0) {
    return {1, 2};
  }
  return thinnest == 1 ? std::array<int, 2>{0, 2} : std::array<int, 2>{0, 1};
}

ChartLine pathLine(const std::vector<double>& times, const std::vector<Eigen::Vector3d>& positions,
                   const std::array<int, 2>& axes) {
  ChartLine line;
  line.times = times;
  for (const Eigen::Vector3d& position : positions) {
    line.points.emplace_back(position[axes[0]], position[axes[1]]);
  }
  return line;
}

struct Legend {
  std::vector<std::string> names;  ///< In the order of appearance.
  std::map<std::string, cv::Scalar> colours;
};

Legend legendOf(const std::vector<Run>& runs) {
  Legend legend;
  for (const Run& run : runs) {
    if (legend.colours.emplace(run.source.system, systemColour(legend.names.size())).second) {
      legend.names.push_back(run.source.system);
    }
  }
  return legend;
}

/// The system's name and the median ATE of its runs.
std::string legendText(const std::vector<Run>& runs, const std::string& system) {
  std::vector<double> rmse;
  for (const Run& run : runs) {
    if (run.source.system == system) {
      rmse.push_back(run.ate->error.rmse);
    }
  }
  return fmt::format("{} (ATE {:.4f} m{})", system, median(rmse),
                     rmse.size() > 1 ? fmt::format(", median of {} runs", rmse.size()) : "");
}

void drawLegend(cv::Mat& picture, const std::vector<Run>& runs, const Legend& legend,
                cv::Point position) {
  const auto drawEntry = [&](const std::string& name, const cv::Scalar& colour) {
    cv::line(picture, position - cv::Point(0, 5), position + cv::Point(30, -5), colour, 3,
             cv::LINE_AA);
    position.x += 38 + drawText(picture, name, position + cv::Point(38, 0)) + 30;
  };
  drawEntry("ground truth", kTruthColour);
  for (const std::string& name : legend.names) {
    drawEntry(legendText(runs, name), legend.colours.at(name));
  }
}

/// The part of the ground truth that the estimates cover.
Trajectory coveredTruth(const Evaluation& evaluation, double offset) {
  double begin = std::numeric_limits<double>::infinity();
  double end = -begin;
  for (const Run& run : evaluation.runs) {
    begin = std::min(begin, run.ate->timestamps.front() + offset);
    end = std::max(end, run.ate->timestamps.back() + offset);
  }
  Trajectory covered;
  for (const StampedPose& stamped : evaluation.groundtruth) {
    if (stamped.timestamp >= begin && stamped.timestamp <= end) {
      covered.push_back(stamped);
    }
  }
  return covered;
}

std::vector<Eigen::Vector3d> positionsOf(const Trajectory& trajectory) {
  std::vector<Eigen::Vector3d> positions;
  positions.reserve(trajectory.size());
  for (const StampedPose& stamped : trajectory) {
    positions.emplace_back(stamped.pose.translation());
  }
  return positions;
}

Chart pathChart(const Evaluation& evaluation, const Legend& legend, double offset) {
  const Trajectory truth = coveredTruth(evaluation, offset);
  // Few poses within the tolerance of a sparse ground truth may enclose none.
  const std::vector<Eigen::Vector3d> positions =
      truth.empty() ? evaluation.runs.front().ate->groundtruth : positionsOf(truth);
  const std::vector<double> times =
      truth.empty() ? evaluation.runs.front().ate->timestamps : timestampsOf(truth);
  const std::array<int, 2> axes = widestAxes(positions);
  const std::array<const char*, 3> labels{"x (m)", "y (m)", "z (m)"};

  Chart chart;
  chart.x_label = labels.at(static_cast<std::size_t>(axes[0]));
  chart.y_label = labels.at(static_cast<std::size_t>(axes[1]));
  chart.has_equal_scales = true;
  chart.lines.push_back(pathLine(times, positions, axes));
  chart.lines.back().colour = kTruthColour;
  chart.lines.back().thickness = 2;
  for (const Run& run : evaluation.runs) {
    chart.lines.push_back(pathLine(run.ate->timestamps, run.ate->estimated, axes));
    chart.lines.back().colour = legend.colours.at(run.source.system);
  }
  return chart;
}

Chart errorChart(const Evaluation& evaluation, const Legend& legend) {
  double start = std::numeric_limits<double>::infinity();
  for (const Run& run : evaluation.runs) {
    start = std::min(start, run.ate->timestamps.front());
  }
  Chart chart;
  chart.x_label = "time (s)";
  chart.y_label = "ATE (m)";
  chart.starts_at_zero = true;
  for (const Run& run : evaluation.runs) {
    ChartLine line;
    line.times = run.ate->timestamps;
    line.colour = legend.colours.at(run.source.system);
    for (std::size_t i = 0; i < line.times.size(); ++i) {
      line.points.emplace_back(line.times[i] - start, run.ate->errors[i]);
    }
    chart.lines.push_back(std::move(line));
  }
  return chart;
}

}  // namespace

cv::Mat drawRuns(const Evaluation& evaluation, double offset) {
  if (evaluation.runs.empty()) {
    throw std::invalid_argument("drawRuns: evaluation has 0 runs; expected at least 1");
  }
  for (const Run& run : evaluation.runs) {
    if (!run.ate) {
      throw std::invalid_argument("drawRuns: a run has no ATE; expected one in each");
    }
  }
  const Legend legend = legendOf(evaluation.runs);
  cv::Mat picture(800, 1600, CV_8UC3, cv::Scalar::all(255));
  drawLegend(picture, evaluation.runs, legend, {80, 30});
  drawChart(picture, {80, 75, 670, 670}, pathChart(evaluation, legend, offset));
  drawChart(picture, {860, 75, 700, 670}, errorChart(evaluation, legend));
  return picture;
}

}  // namespace hmcdyn::evaluate

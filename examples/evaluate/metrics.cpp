// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/metrics.hpp"

#include <utility>

#include <fmt/format.h>

#include "evaluate/rates.hpp"

namespace hmcdyn::evaluate {
namespace {

using StatisticsOf = std::function<const Statistics&(const Run&)>;

const Statistics& ateOf(const Run& run) { return run.ate->error; }
const Statistics& translationOf(const Run& run) { return run.rpe->translation; }
const Statistics& rotationOf(const Run& run) { return run.rpe->rotation; }

Metric statisticMetric(const std::string& pointer, const std::string& title,
                       double Statistics::*field, bool is_compared, const StatisticsOf& of) {
  return {pointer, title, 6, is_compared, [=](const Run& run) { return of(run).*field; }};
}

Metric pairsMetric(const std::string& pointer, const StatisticsOf& of) {
  return {pointer, "pairs", 0, false,
          [of](const Run& run) { return static_cast<double>(of(run).count); }};
}

std::vector<Metric> statisticsMetrics(const std::string& prefix, const StatisticsOf& of) {
  // The paper compares RMSE and standard deviation.
  return {statisticMetric(prefix + "/rmse", "rmse", &Statistics::rmse, true, of),
          statisticMetric(prefix + "/mean", "mean", &Statistics::mean, false, of),
          statisticMetric(prefix + "/median", "median", &Statistics::median, false, of),
          statisticMetric(prefix + "/std", "std", &Statistics::std, true, of),
          statisticMetric(prefix + "/min", "min", &Statistics::min, false, of),
          statisticMetric(prefix + "/max", "max", &Statistics::max, false, of),
          pairsMetric(prefix + "/pairs", of)};
}

Metric scaleMetric() {
  return {"/scale", "scale", 6, false, [](const Run& run) { return run.ate->alignment.scale; }};
}

bool knowsFrames(const Arguments& arguments) {
  return arguments.frames.has_value() || !arguments.associations.empty();
}

std::vector<Metric> trackingMetrics() {
  return {{"/frames", "frames", 0, false,
           [](const Run& run) { return static_cast<double>(run.tracking->frames); }},
          {"/frames_tracked", "tracked", 0, false,
           [](const Run& run) { return static_cast<double>(run.tracking->tracked); }},
          {"/tracking_rate", "rate (%)", 2, false, [](const Run& run) {
             return trackingRate(run.tracking->tracked, run.tracking->frames);
           }}};
}

void append(std::vector<Metric>& metrics, std::vector<Metric> more) {
  metrics.insert(metrics.end(), std::make_move_iterator(more.begin()),
                 std::make_move_iterator(more.end()));
}

std::string ateHeading(const Arguments& arguments) {
  return fmt::format("Absolute trajectory error (m) after {} alignment",
                     arguments.scale ? "similarity" : "rigid");
}

std::string rpeHeading(const Arguments& arguments, const char* of) {
  return fmt::format("Relative pose error per {} {}: {}", arguments.delta,
                     toString(arguments.delta_unit), of);
}

std::vector<Metric> summaryColumns(const Arguments& arguments) {
  std::vector<Metric> columns{
      statisticMetric("", "ATE rmse (m)", &Statistics::rmse, true, ateOf),
      statisticMetric("", "ATE std (m)", &Statistics::std, false, ateOf), pairsMetric("", ateOf),
      statisticMetric("", "RPE rmse (m)", &Statistics::rmse, true, translationOf),
      statisticMetric("", "RPE rmse (deg)", &Statistics::rmse, true, rotationOf)};
  if (knowsFrames(arguments)) {
    append(columns, trackingMetrics());
  }
  return columns;
}

}  // namespace

std::vector<Metric> allMetrics(const Arguments& arguments) {
  std::vector<Metric> metrics;
  if (arguments.command == Command::kAte) {
    metrics = statisticsMetrics("", ateOf);
  } else if (arguments.command == Command::kRpe) {
    metrics = statisticsMetrics("/translation", translationOf);
    append(metrics, statisticsMetrics("/rotation", rotationOf));
  } else {
    metrics = statisticsMetrics("/ate", ateOf);
    append(metrics, statisticsMetrics("/rpe/translation", translationOf));
    append(metrics, statisticsMetrics("/rpe/rotation", rotationOf));
    if (knowsFrames(arguments)) {
      append(metrics, trackingMetrics());
    }
  }
  if (arguments.scale) {
    metrics.push_back(scaleMetric());
  }
  return metrics;
}

std::vector<Section> tableSections(const Arguments& arguments) {
  std::vector<Section> sections;
  if (arguments.command == Command::kAte) {
    sections = {{ateHeading(arguments), statisticsMetrics("", ateOf)}};
  } else if (arguments.command == Command::kRpe) {
    sections = {{rpeHeading(arguments, "translation (m)"), statisticsMetrics("", translationOf)},
                {rpeHeading(arguments, "rotation (deg)"), statisticsMetrics("", rotationOf)}};
  } else {
    sections = {{ateHeading(arguments) + "; relative pose error (RPE) per " +
                     fmt::format("{} {}", arguments.delta, toString(arguments.delta_unit)),
                 summaryColumns(arguments)}};
  }
  if (arguments.scale) {
    sections.front().metrics.push_back(scaleMetric());
  }
  return sections;
}

}  // namespace hmcdyn::evaluate

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "evaluate/command_line.hpp"
#include "evaluate/runs.hpp"

namespace hmcdyn::evaluate {

/// A figure of a run that a report shows.
struct Metric {
  std::string pointer;                      ///< Where it stands in a run's JSON, a JSON pointer.
  std::string title;                        ///< Heading of its column.
  int decimals = 6;                         ///< Digits behind the point; 0 for counts.
  bool is_compared = false;                 ///< Whether its improvement over a baseline is shown.
  std::function<double(const Run&)> value;  ///< Reads it from a run.
};

/// Metrics that stand in one table.
struct Section {
  std::string heading;
  std::vector<Metric> metrics;
};

/// Every metric of the command, for JSON.
std::vector<Metric> allMetrics(const Arguments& arguments);

/// The tables of the command.
std::vector<Section> tableSections(const Arguments& arguments);

}  // namespace hmcdyn::evaluate

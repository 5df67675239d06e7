// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/report.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "evaluate/metrics.hpp"
#include "evaluate/rates.hpp"
#include "evaluate/statistics.hpp"

namespace hmcdyn::evaluate {
namespace {

using Json = nlohmann::ordered_json;

/// The runs of one system, in the order given.
struct System {
  std::string name;
  bool is_baseline = false;
  std::vector<const Run*> runs;
};

std::vector<System> groupBySystem(const std::vector<Run>& runs) {
  std::vector<System> systems;
  for (const Run& run : runs) {
    auto system = std::find_if(systems.begin(), systems.end(), [&](const System& candidate) {
      return candidate.name == run.source.system;
    });
    if (system == systems.end()) {
      system = systems.insert(systems.end(), {run.source.system, run.is_baseline, {}});
    }
    system->runs.push_back(&run);
  }
  return systems;
}

/// Statistics of a metric over the runs of a system.
Statistics overRuns(const Metric& metric, const System& system) {
  std::vector<double> values;
  values.reserve(system.runs.size());
  for (const Run* run : system.runs) {
    values.push_back(metric.value(*run));
  }
  return computeStatistics(values);
}

/// A metric's median over the baseline's runs; none where there is no baseline, or where its error
/// is 0 and cannot be improved.
std::optional<double> baselineOf(const Metric& metric, const std::vector<System>& systems) {
  if (!metric.is_compared || !systems.front().is_baseline) {
    return std::nullopt;
  }
  const double baseline = overRuns(metric, systems.front()).median;
  return baseline > 0.0 ? std::optional<double>(baseline) : std::nullopt;
}

/// A row of every table: a run, or a statistic over the runs of a system.
struct Row {
  std::string label;
  bool is_baseline = false;
  std::function<double(const Metric&)> value;
};

std::string runLabel(const System& system, std::size_t i) {
  if (system.name == kUnnamedSystem) {
    return system.runs[i]->source.file.string();
  }
  return system.runs.size() == 1 ? system.name : fmt::format("{} {}", system.name, i + 1);
}

std::vector<Row> rowsOf(const System& system) {
  std::vector<Row> rows;
  for (std::size_t i = 0; i < system.runs.size(); ++i) {
    rows.push_back({runLabel(system, i), system.is_baseline,
                    [run = system.runs[i]](const Metric& metric) { return metric.value(*run); }});
  }
  if (system.runs.size() > 1) {
    const std::string prefix = system.name == kUnnamedSystem ? "" : system.name + ", ";
    const auto addStatistic = [&](const std::string& label, double Statistics::*field) {
      rows.push_back({prefix + label, system.is_baseline, [&system, field](const Metric& metric) {
                        return overRuns(metric, system).*field;
                      }});
    };
    addStatistic(fmt::format("median of {} runs", system.runs.size()), &Statistics::median);
    addStatistic("lowest", &Statistics::min);
    addStatistic("highest", &Statistics::max);
  }
  return rows;
}

/// A column's title and the cells below it.
using Column = std::vector<std::string>;

Column valueColumn(const Metric& metric, const std::vector<Row>& rows) {
  Column column{metric.title};
  for (const Row& row : rows) {
    column.push_back(fmt::format("{:.{}f}", row.value(metric), metric.decimals));
  }
  return column;
}

Column improvementColumn(const Metric& metric, const std::vector<Row>& rows,
                         std::optional<double> baseline) {
  Column column{"better by"};
  for (const Row& row : rows) {
    column.push_back(baseline && !row.is_baseline
                         ? fmt::format("{:.1f} %", improvement(*baseline, row.value(metric)))
                         : "-");
  }
  return column;
}

std::string format(const Section& section, const std::vector<System>& systems,
                   const std::vector<Row>& rows) {
  Column labels{""};
  for (const Row& row : rows) {
    labels.push_back(row.label);
  }
  std::vector<Column> columns;
  for (const Metric& metric : section.metrics) {
    columns.push_back(valueColumn(metric, rows));
    if (metric.is_compared && systems.front().is_baseline) {
      columns.push_back(improvementColumn(metric, rows, baselineOf(metric, systems)));
    }
  }
  const auto widthOf = [](const Column& column) {
    return std::max_element(column.begin(), column.end(),
                            [](const auto& a, const auto& b) { return a.size() < b.size(); })
        ->size();
  };
  std::string text = section.heading + "\n";
  for (std::size_t i = 0; i < labels.size(); ++i) {
    text += fmt::format("  {:<{}}", labels[i], widthOf(labels));
    for (const Column& column : columns) {
      text += fmt::format("  {:>{}}", column[i], widthOf(column));
    }
    text += "\n";
  }
  return text;
}

void setNumber(Json& json, const std::string& pointer, double value, int decimals) {
  Json& place = json[Json::json_pointer(pointer)];
  if (decimals == 0) {
    place = std::llround(value);
  } else {
    place = value;
  }
}

Json runToJson(const std::vector<Metric>& metrics, const Run& run) {
  Json json{{"file", run.source.file.string()}};
  for (const Metric& metric : metrics) {
    setNumber(json, metric.pointer, metric.value(run), metric.decimals);
  }
  return json;
}

Json systemToJson(const std::vector<Metric>& metrics, const System& system,
                  const std::vector<System>& systems) {
  Json json{{"system", system.name}, {"runs", system.runs.size()}};
  for (const Metric& metric : metrics) {
    const Statistics statistics = overRuns(metric, system);
    json[Json::json_pointer(metric.pointer)] = {{"median", statistics.median},
                                                {"mean", statistics.mean},
                                                {"std", statistics.std},
                                                {"min", statistics.min},
                                                {"max", statistics.max}};
    const std::optional<double> baseline = baselineOf(metric, systems);
    if (baseline && !system.is_baseline) {
      json[Json::json_pointer("/improvement" + metric.pointer)] =
          improvement(*baseline, statistics.median);
    }
  }
  return json;
}

}  // namespace

std::string toTable(const Arguments& arguments, const std::vector<Run>& runs) {
  const std::vector<System> systems = groupBySystem(runs);
  std::vector<Row> rows;
  for (const System& system : systems) {
    const std::vector<Row> more = rowsOf(system);
    rows.insert(rows.end(), more.begin(), more.end());
  }
  std::string text;
  for (const Section& section : tableSections(arguments)) {
    text += (text.empty() ? "" : "\n") + format(section, systems, rows);
  }
  return text;
}

std::string toJson(const Arguments& arguments, const std::vector<Run>& runs) {
  const std::vector<Metric> metrics = allMetrics(arguments);
  Json json;
  if (runs.size() == 1) {
    json = runToJson(metrics, runs.front());
  } else {
    const std::vector<System> systems = groupBySystem(runs);
    json["runs"] = Json::array();
    for (const Run& run : runs) {
      Json entry = runToJson(metrics, run);
      entry["system"] = run.source.system;
      json["runs"].push_back(std::move(entry));
    }
    json["systems"] = Json::array();
    for (const System& system : systems) {
      json["systems"].push_back(systemToJson(metrics, system, systems));
    }
  }
  if (arguments.command != Command::kAte) {
    json["delta"] = arguments.delta;
    json["delta_unit"] = toString(arguments.delta_unit);
  }
  return json.dump(2) + "\n";
}

}  // namespace hmcdyn::evaluate

// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/result_tables.hpp"

#include <algorithm>
#include <functional>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "evaluate/rates.hpp"
#include "evaluate/statistics.hpp"

namespace hmcdyn::evaluate {
namespace {

using Value = std::function<std::optional<double>(const RunSummary&)>;

/// A variant of ours and the system of the paper that it stands beside.
struct System {
  const char* variant;
  const char* shown;
  const char* paper;  ///< Empty = none.
};

/// A figure of a table: how to get it from a run, and how the paper's data file calls it.
struct Metric {
  const char* shown;
  const char* paper;
  int decimals;
  Value value;
};

using ErrorMember = std::optional<ErrorSummary> RunSummary::*;

Value rmseOf(ErrorMember member) {
  return [member](const RunSummary& run) {
    return run.*member ? std::optional<double>((run.*member)->rmse) : std::nullopt;
  };
}

Value sdOf(ErrorMember member) {
  return [member](const RunSummary& run) {
    return run.*member ? std::optional<double>((run.*member)->sd) : std::nullopt;
  };
}

std::optional<double> rateOf(const RunSummary& run) {
  return trackingRate(run.tracked, run.frames);
}
std::optional<double> timeOf(const RunSummary& run) { return run.tracking_ms; }

std::vector<double> valuesOf(const std::vector<RunSummary>& runs, const std::string& sequence,
                             const std::string& variant, const Value& value) {
  std::vector<double> values;
  for (const RunSummary& run : runs) {
    if (run.sequence == sequence && run.variant == variant) {
      if (const std::optional<double> of_run = value(run)) {
        values.push_back(*of_run);
      }
    }
  }
  return values;
}

std::string withSpread(const std::vector<double>& values, int decimals) {
  if (values.empty()) {
    return "-";
  }
  const Statistics statistics = computeStatistics(values);
  const std::string mean = fmt::format("{:.{}f}", statistics.mean, decimals);
  return values.size() == 1 ? mean
                            : fmt::format("{} ({:.{}f}-{:.{}f})", mean, statistics.min, decimals,
                                          statistics.max, decimals);
}

std::string paperCell(const std::optional<double>& value, int decimals) {
  return value ? fmt::format("{:.{}f}", *value, decimals) : "-";
}

std::vector<std::string> sequencesOf(const std::vector<RunSummary>& runs) {
  std::set<std::string> names;
  for (const RunSummary& run : runs) {
    names.insert(run.sequence);
  }
  return {names.begin(), names.end()};
}

/// A row a sequence; a column a system and metric, the paper's beside ours.
ResultTable compare(const std::string& number, const std::vector<System>& systems,
                    const std::vector<Metric>& metrics, const std::vector<RunSummary>& runs,
                    const std::vector<PaperValue>& paper) {
  ResultTable table;
  table.header = {"sequence", "runs"};
  for (const System& system : systems) {
    for (const Metric& metric : metrics) {
      table.header.push_back(fmt::format("{} {}", system.shown, metric.shown));
      if (*system.paper != '\0' && *metric.paper != '\0') {
        table.header.push_back(fmt::format("paper: {} {}", system.paper, metric.shown));
      }
    }
  }
  for (const std::string& sequence : sequencesOf(runs)) {
    std::size_t fewest = runs.size();
    std::size_t most = 0;
    std::vector<std::string> cells;
    for (const System& system : systems) {
      const std::size_t count = valuesOf(runs, sequence, system.variant, rateOf).size();
      fewest = std::min(fewest, count);
      most = std::max(most, count);
      for (const Metric& metric : metrics) {
        cells.push_back(
            withSpread(valuesOf(runs, sequence, system.variant, metric.value), metric.decimals));
        if (*system.paper != '\0' && *metric.paper != '\0') {
          cells.push_back(paperCell(
              findPaperValue(paper, number, paperSequence(sequence), system.paper, metric.paper),
              metric.decimals));
        }
      }
    }
    std::vector<std::string> row{
        sequence, fewest == most ? fmt::format("{}", most) : fmt::format("{}-{}", fewest, most)};
    row.insert(row.end(), cells.begin(), cells.end());
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::vector<System> ablations() {
  return {{"rs", "RS", "RS"},
          {"df", "DF", "DF"},
          {"opw", "OPW", "OPW"},
          {"hmc", "hmc", "HMC"},
          {"robust", "robust", ""}};
}

std::vector<System> peers() {
  return {{"none", "none", "ORB-SLAM3"},
          {"chi2", "chi2", "OVD-SLAM"},
          {"two_threshold", "two_threshold", "SG-SLAM"},
          {"depth_ransac", "depth_ransac", ""},
          {"hmc", "hmc", "HMC"},
          {"robust", "robust", ""}};
}

/// Table VI: a row a system, over the means of the sequences.
ResultTable timeTable(const std::vector<RunSummary>& runs, const std::vector<PaperValue>& paper) {
  ResultTable table;
  table.header = {"system", "ours (ms)", "paper's system", "paper (ms)"};
  for (const System& system : peers()) {
    std::vector<double> means;
    for (const std::string& sequence : sequencesOf(runs)) {
      const std::vector<double> times = valuesOf(runs, sequence, system.variant, timeOf);
      if (!times.empty()) {
        means.push_back(computeStatistics(times).mean);
      }
    }
    table.rows.push_back(
        {system.shown, withSpread(means, 2), *system.paper == '\0' ? "-" : system.paper,
         paperCell(findPaperValue(paper, "VI", "mean", system.paper, "time_ms"), 2)});
  }
  return table;
}

std::optional<double> meanOf(const std::vector<double>& values) {
  return values.empty() ? std::nullopt : std::optional<double>(computeStatistics(values).mean);
}

std::optional<double> improvementOf(const std::optional<double>& baseline,
                                    const std::optional<double>& error) {
  return baseline && error && *baseline > 0.0
             ? std::optional<double>(improvement(*baseline, *error))
             : std::nullopt;
}

/// Eq. 12 of hmc over none, a row a sequence, and the mean of the rows.
ResultTable improvementTable(const std::vector<RunSummary>& runs,
                             const std::vector<PaperValue>& paper) {
  ResultTable table;
  table.header = {"sequence", "ours (%)", "paper: over ORB-SLAM3 (%)"};
  std::vector<double> ours;
  std::vector<double> papers;
  for (const std::string& sequence : sequencesOf(runs)) {
    const Value rmse = rmseOf(&RunSummary::ate);
    const std::optional<double> here = improvementOf(meanOf(valuesOf(runs, sequence, "none", rmse)),
                                                     meanOf(valuesOf(runs, sequence, "hmc", rmse)));
    const std::string name = paperSequence(sequence);
    const std::optional<double> there =
        improvementOf(findPaperValue(paper, "III", name, "ORB-SLAM3", "ate_rmse"),
                      findPaperValue(paper, "III", name, "HMC", "ate_rmse"));
    if (here) {
      ours.push_back(*here);
    }
    if (there) {
      papers.push_back(*there);
    }
    table.rows.push_back({sequence, paperCell(here, 1), paperCell(there, 1)});
  }
  table.rows.push_back({"mean", paperCell(meanOf(ours), 1), paperCell(meanOf(papers), 1)});
  return table;
}

ResultTable named(ResultTable table, std::string name, std::string title, std::string note) {
  table.name = std::move(name);
  table.title = std::move(title);
  table.note = std::move(note);
  return table;
}

std::string quoted(const std::string& field) {
  if (field.find_first_of(",\"\n") == std::string::npos) {
    return field;
  }
  std::string text = "\"";
  for (const char c : field) {
    text += c;
    if (c == '"') {
      text += c;
    }
  }
  return text + "\"";
}

}  // namespace

std::vector<ResultTable> makeTables(const std::vector<RunSummary>& runs,
                                    const std::vector<PaperValue>& paper, bool rendered) {
  const std::string origin =
      rendered ? "The sequences are rendered; the paper's figures are of the real sequences that "
                 "the scenes are named after, and not comparable."
               : "";
  const std::string peers_note =
      "none, chi2, two_threshold and depth_ransac are rules inside our system, not the programs "
      "ORB-SLAM3, OVD-SLAM, SG-SLAM and YOLO-SLAM. " +
      origin;
  const auto errors = [](ErrorMember member, const char* rmse, const char* sd, int decimals) {
    return std::vector<Metric>{{"RMSE", rmse, decimals, rmseOf(member)},
                               {"S.D.", sd, decimals, sdOf(member)}};
  };
  const std::vector<Metric> ate = errors(&RunSummary::ate, "ate_rmse", "ate_sd", 4);
  return {
      named(compare("I", ablations(), ate, runs, paper), "table_1", "Table I: ablation, ATE (m)",
            origin),
      // The paper's times are those of single modules, ours those of the tracking thread.
      named(compare("II", ablations(),
                    {{"tracking rate (%)", "tracking_rate", 1, rateOf},
                     {"tracking (ms CPU)", "", 2, timeOf}},
                    runs, paper),
            "table_2", "Table II: ablation, tracking rate (eq. 11) and time a frame",
            "Times are the tracking thread's, without the detector; the paper's Table II has those "
            "of single modules, which are not repeated here. " +
                origin),
      named(compare("III", peers(), ate, runs, paper), "table_3", "Table III: ATE (m)", peers_note),
      named(
          compare("IV", peers(),
                  errors(&RunSummary::translation, "rpe_translation_rmse", "rpe_translation_sd", 4),
                  runs, paper),
          "table_4", "Table IV: translational RPE (m/s)", peers_note),
      named(compare("V", peers(),
                    errors(&RunSummary::rotation, "rpe_rotation_rmse", "rpe_rotation_sd", 4), runs,
                    paper),
            "table_5", "Table V: rotational RPE (deg/s)", peers_note),
      named(timeTable(runs, paper), "table_6", "Table VI: time a frame",
            "Ours: CPU time of the tracking thread without the detector, mean over the sequences, "
            "lowest and highest in brackets; the paper's: whole systems on other hardware."),
      named(improvementTable(runs, paper), "improvement",
            "Improvement of hmc over no filter, ATE RMSE (eq. 12)", origin)};
}

std::string toMarkdown(const ResultTable& table) {
  const auto line = [](const std::vector<std::string>& cells) {
    return fmt::format("| {} |\n", fmt::join(cells, " | "));
  };
  std::string text = fmt::format("## {}\n\n{}", table.title, line(table.header));
  text += "|" +
          fmt::format("{}", fmt::join(std::vector<std::string>(table.header.size(), "---"), "|")) +
          "|\n";
  for (const std::vector<std::string>& row : table.rows) {
    text += line(row);
  }
  return table.note.empty() ? text : text + "\n" + table.note + "\n";
}

std::string toCsv(const ResultTable& table) {
  const auto line = [](const std::vector<std::string>& cells) {
    std::vector<std::string> fields(cells.size());
    std::transform(cells.begin(), cells.end(), fields.begin(), quoted);
    return fmt::format("{}\n", fmt::join(fields, ","));
  };
  std::string text = line(table.header);
  for (const std::vector<std::string>& row : table.rows) {
    text += line(row);
  }
  return text;
}

}  // namespace hmcdyn::evaluate

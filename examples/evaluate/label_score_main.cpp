// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "evaluate/label_score.hpp"
#include "support/command_line.hpp"

namespace {

using hmcdyn::evaluate::LabelScore;

LabelScore operator+(LabelScore sum, const LabelScore& other) {
  sum.true_dynamic += other.true_dynamic;
  sum.false_dynamic += other.false_dynamic;
  sum.missed_dynamic += other.missed_dynamic;
  sum.true_static += other.true_static;
  sum.static_in_boxes += other.static_in_boxes;
  sum.kept_in_boxes += other.kept_in_boxes;
  sum.on_border += other.on_border;
  sum.standing += other.standing;
  sum.without_mask += other.without_mask;
  return sum;
}

nlohmann::json toJson(const std::string& name, const LabelScore& score) {
  return {{"scene", name},
          {"precision", score.precision()},
          {"recall", score.recall()},
          {"f1", score.f1()},
          {"kept_static_in_boxes", score.keptShare()},
          {"points",
           {{"true_dynamic", score.true_dynamic},
            {"false_dynamic", score.false_dynamic},
            {"missed_dynamic", score.missed_dynamic},
            {"true_static", score.true_static},
            {"on_border", score.on_border},
            {"standing", score.standing},
            {"without_mask", score.without_mask}}}};
}

void printRow(const std::string& name, const LabelScore& score) {
  fmt::print("{:<20} {:>9.3f} {:>7.3f} {:>7.3f} {:>6.3f} {:>8} {:>8} {:>8} {:>8}\n", name,
             score.precision(), score.recall(), score.f1(), score.keptShare(),
             score.true_dynamic + score.missed_dynamic, score.true_static + score.false_dynamic,
             score.on_border, score.standing);
}

struct Arguments {
  std::vector<std::string> runs;
  hmcdyn::evaluate::LabelScoreOptions options;
  bool json = false;
};

void run(const Arguments& arguments) {
  nlohmann::json report = nlohmann::json::array();
  LabelScore total;
  if (!arguments.json) {
    fmt::print("{:<20} {:>9} {:>7} {:>7} {:>6} {:>8} {:>8} {:>8} {:>8}\n", "scene", "precision",
               "recall", "F1", "kept", "moving", "static", "border", "standing");
  }
  for (const std::string& pair : arguments.runs) {
    const std::size_t colon = pair.rfind(':');
    if (colon == std::string::npos) {
      throw std::runtime_error("'" + pair + "' is no SEQUENCE:KEYPOINTS pair");
    }
    const std::filesystem::path sequence = pair.substr(0, colon);
    const std::string file = pair.substr(colon + 1);
    const std::vector<hmcdyn::evaluate::LabelledPoint> points =
        hmcdyn::evaluate::readLabelledPoints(file);
    if (points.empty()) {
      throw std::runtime_error(file + ": holds no key point; expected some behind the header");
    }
    const LabelScore score = scoreLabels(points, sequence, arguments.options);
    const std::string name = sequence.filename().string();
    total = total + score;
    if (arguments.json) {
      report.push_back(toJson(name, score));
    } else {
      printRow(name, score);
    }
  }
  if (arguments.json) {
    report.push_back(toJson("all", total));
    std::cout << report.dump(2) << '\n';
  } else if (arguments.runs.size() > 1) {
    printRow("all", total);
  }
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app(
      "Scores the labels in keypoints.csv (hmcdyn_slam --write-keypoints) against the masks of a\n"
      "rendered sequence (hmcdyn_synthesize): precision, recall and F1 of 'dynamic', and the "
      "share\n"
      "of static points inside boxes that were kept.",
      "hmcdyn_label_score");
  app.footer(
      "Scored are the points whose class is beyond doubt. Left out, and counted: 'border', points "
      "within\nthe margin of another class in the mask, and 'standing', points on people who stand "
      "still. A FAST\ncorner is decided by a ring of 3 px at its pyramid level: within that of a "
      "silhouette it is made of\nboth sides and lies on neither. --margin 2 scores more of them, "
      "and is what earlier figures used;\ngive both, as the ring leaves out the hardest points. "
      "What is not called dynamic counts as static.\n"
      "Example: hmcdyn_label_score walking_xyz:out/keypoints.csv\n"
      "Exit code: 0 done, 1 a file is missing or malformed, 2 wrong usage.");
  app.add_option("runs", arguments.runs, "Sequence folder and key points of a run")
      ->type_name("SEQUENCE:KEYPOINTS")
      ->required();
  app.add_option(
         "--margin", arguments.options.margin,
         "Points this near (px) to a border in the mask are not scored (default: \"detector "
         "ring\", 3 px at the pyramid level of the point, rounded up; without a column "
         "'size' in the file 3 px)")
      ->check(hmcdyn::support::zeroOrMore());
  app.add_option("--skip-frames", arguments.options.skip_frames,
                 "So many first frames are left out")
      ->capture_default_str();
  app.add_flag("--json", arguments.json, "Print JSON instead of a table");
  if (const auto code = hmcdyn::support::parseCommandLine(app, argc, argv)) {
    return *code;
  }
  return hmcdyn::support::exitCodeOf("hmcdyn_label_score", [&] { run(arguments); });
}

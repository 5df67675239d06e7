// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "mask/mask_score.hpp"
#include "support/command_line.hpp"

namespace {

using hmcdyn::masking::MaskScore;

double median(std::vector<double> values) {
  if (values.empty()) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

double share(std::size_t part, std::size_t whole) {
  return whole > 0 ? static_cast<double>(part) / static_cast<double>(whole)
                   : std::numeric_limits<double>::quiet_NaN();
}

std::string cell(double value, int width, int decimals) {
  return std::isfinite(value) ? fmt::format("{:>{}.{}f}", value, width, decimals)
                              : fmt::format("{:>{}}", "-", width);
}

void printRow(const std::string& name, const MaskScore& s) {
  fmt::print("{:<22} {} {} {} {} {} {} {} {} {:>6} {}\n", name, cell(s.iou(), 6, 3),
             cell(s.precision(), 9, 3), cell(s.recall(), 6, 3), cell(s.boundaryF(), 6, 3),
             cell(100.0 * s.falseShare(), 8, 2),
             cell(s.standing > 0 ? s.standing_as_moving / s.standing : NAN, 8, 3),
             cell(share(s.things_found, s.things), 6, 3), cell(median(s.seconds_to_find), 7, 2),
             s.never_found, cell(median(s.seconds_to_release), 8, 2));
}

nlohmann::json number(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

nlohmann::json toJson(const std::string& name, const MaskScore& s) {
  return {{"sequence", name},
          {"frames", s.frames},
          {"without_mask", s.without_mask},
          {"iou", number(s.iou())},
          {"precision", number(s.precision())},
          {"recall", number(s.recall())},
          {"boundary_f", number(s.boundaryF())},
          {"false_share", number(s.falseShare())},
          {"standing_as_moving", number(s.standing > 0 ? s.standing_as_moving / s.standing : NAN)},
          {"things", s.things},
          {"things_found", s.things_found},
          {"seconds_to_find", s.seconds_to_find},
          {"never_found", s.never_found},
          {"seconds_to_release", s.seconds_to_release},
          {"never_released", s.never_released}};
}

struct Arguments {
  std::vector<std::string> runs;
  hmcdyn::masking::MaskScoreOptions options;
  bool json = false;
};

void run(const Arguments& arguments) {
  nlohmann::json report = nlohmann::json::array();
  if (!arguments.json) {
    fmt::print("{:<22} {:>6} {:>9} {:>6} {:>6} {:>8} {:>8} {:>6} {:>7} {:>6} {:>8}\n", "sequence",
               "IoU", "precision", "recall", "edge F", "false %", "standing", "things", "find s",
               "unfound", "release s");
  }
  for (const std::string& pair : arguments.runs) {
    const std::size_t colon = pair.rfind(':');
    if (colon == std::string::npos) {
      throw std::runtime_error("'" + pair + "' is no SEQUENCE:FOLDER pair");
    }
    const std::filesystem::path sequence = pair.substr(0, colon);
    const MaskScore score =
        hmcdyn::masking::scoreMasks(sequence, pair.substr(colon + 1), arguments.options);
    if (score.without_mask > 0) {
      fmt::print(stderr,
                 "hmcdyn_mask_score: {}: {} frames have no mask, and count as masks of nothing\n",
                 pair.substr(colon + 1), score.without_mask);
    }
    const std::string name =
        (sequence.has_filename() ? sequence : sequence.parent_path()).filename().string();
    if (arguments.json) {
      report.push_back(toJson(name, score));
    } else {
      printRow(name, score);
    }
  }
  if (arguments.json) {
    std::cout << report.dump(2) << '\n';
  }
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app(
      "Scores motion masks (hmcdyn_mask, or anybody's) against true ones: intersection over "
      "union,\n"
      "precision and recall of the moving pixels, their borders, and how soon things are found.",
      "hmcdyn_mask_score");
  app.footer(
      "Truth: SEQUENCE/mask/STAMP.png, 255 moves, 0 does not; 128 (stands) and 64 are left out. A "
      "sequence\nwithout mask/ has nothing that moves. Masks: FOLDER/STAMP.png, 255 moves; stamps "
      "agree to the\nmillisecond. Columns: edge F, border pixels that agree within --edge; false "
      "%, pixels wrongly called\nmoving; standing, share of pixels that stand and are called "
      "moving; things, share of moving things\n(connected parts of the truth, a frame each) of "
      "which half was found; find s and release s, median\ntime from a thing's first move (or "
      "its stop) until more (or less) than half of it is called moving;\nunfound, things that "
      "left or stopped before that.\n"
      "Example: hmcdyn_mask_score walking_xyz:out/mask\n"
      "Exit code: 0 done, 1 a file is missing or malformed, 2 wrong usage.");
  app.add_option("runs", arguments.runs, "Sequence folder and folder of masks")
      ->type_name("SEQUENCE:FOLDER")
      ->required();
  app.add_option("--skip-frames", arguments.options.skip_frames,
                 "So many first frames are left out")
      ->capture_default_str();
  app.add_option("--edge", arguments.options.border_distance, "Borders this near (px) agree")
      ->check(CLI::Range(0, 50))
      ->capture_default_str();
  app.add_flag("--json", arguments.json, "Print JSON instead of a table");
  if (const auto code = hmcdyn::support::parseCommandLine(app, argc, argv)) {
    return *code;
  }
  return hmcdyn::support::exitCodeOf("hmcdyn_mask_score", [&] { run(arguments); });
}

// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/command_line.hpp"

#include <cmath>
#include <map>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "support/command_line.hpp"
#include "support/time_unit_option.hpp"

namespace hmcdyn::evaluate {
namespace {

constexpr const char* kDescription =
    "Compares estimated camera trajectories with the ground truth, as the tools of the TUM RGB-D\n"
    "benchmark do. Trajectories are text files with a line a pose:\n"
    "  timestamp tx ty tz qx qy qz qw    (seconds, metres, unit quaternion)\n";

constexpr const char* kFooter =
    "Examples:\n"
    "  hmcdyn_evaluate ate --groundtruth groundtruth.txt --estimate trajectory.txt\n"
    "  hmcdyn_evaluate rpe -g groundtruth.txt -e trajectory.txt --delta 1 --delta-unit s --json\n"
    "  hmcdyn_evaluate summary -g groundtruth.txt --baseline none=off/trajectory.txt \\\n"
    "      --estimate hmc=on/trajectory.txt --associations rgb.txt --plot comparison.png\n"
    "Five runs of one system, with their median and spread:\n"
    "  hmcdyn_evaluate ate -g groundtruth.txt -e run1.txt run2.txt run3.txt run4.txt run5.txt\n"
    "Exit code: 0 done, 1 a file is missing or its data cannot be used, 2 wrong usage.\n";

/// `NAME=FILE`, or a file alone. A file whose name holds '=' is found when it exists.
SystemFile parseSystemFile(const std::string& text, const std::string& default_system) {
  const std::size_t equals = text.find('=');
  const bool has_name = equals != std::string::npos && equals > 0 && text.find('/') > equals &&
                        !std::filesystem::exists(text);
  if (!has_name) {
    return {default_system, text};
  }
  return {text.substr(0, equals), text.substr(equals + 1)};
}

/// The command line as CLI11 fills it.
struct RawArguments {
  Arguments arguments;
  std::vector<std::string> estimates;
  std::vector<std::string> baselines;
};

void addCommonOptions(CLI::App& app, RawArguments& raw) {
  Arguments& arguments = raw.arguments;
  app.footer(kFooter);
  app.add_option("-g,--groundtruth", arguments.groundtruth, "Ground-truth trajectory")
      ->type_name("FILE")
      ->required();
  static const std::map<std::string, TruthFrame> kFrames{
      {"camera", TruthFrame::kCamera}, {"bonn-markers", TruthFrame::kBonnMarkers}};
  app.add_option("--groundtruth-of", arguments.truth_frame,
                 "Whose poses the ground truth has. Those of the BONN data set are of the markers\n"
                 "on the camera, 2 cm beside it: bonn-markers takes that into account. Published\n"
                 "results do not. Default: camera, the poses as they are")
      ->type_name("FRAME")
      ->transform(CLI::CheckedTransformer(kFrames).description("{camera,bonn-markers}"));
  app.add_option(
         "-e,--estimate", raw.estimates,
         "Estimated trajectories. Those without a name, or with the same, count as runs of\n"
         "one system: their median, lowest and highest values are printed, too")
      ->type_name("[NAME=]FILE")
      ->required();
  app.add_option("--baseline", raw.baselines,
                 "Trajectories of the system to compare with: prints by how many per cent each\n"
                 "error lies below its median, (o - r) / o")
      ->type_name("[NAME=]FILE");
  app.add_option("--tolerance", arguments.tolerance,
                 "Largest time difference of a pose and its ground truth (s). Default: ATE 0.02;\n"
                 "RPE twice the median interval of the ground truth")
      ->type_name("S")
      ->check(support::aboveZero());
  app.add_option("--offset", arguments.offset, "Added to the estimate's time stamps (s)")
      ->type_name("S")
      ->capture_default_str();
  support::addTimeUnit(app, arguments.time_unit, "Of the time stamps in all files");
  app.add_flag("--scale", arguments.scale,
               "Fit a scale, too (Sim(3) alignment), for systems that cannot know it");
  app.add_flag("--json", arguments.json, "Print JSON instead of a table");
  app.add_option("-o,--output", arguments.output, "Write the table or JSON to a file instead")
      ->type_name("FILE");
}

void addDeltaOptions(CLI::App& app, Arguments& arguments) {
  static const std::map<std::string, DeltaUnit> kUnits{{"s", DeltaUnit::kSeconds},
                                                       {"m", DeltaUnit::kMetres},
                                                       {"rad", DeltaUnit::kRadians},
                                                       {"deg", DeltaUnit::kDegrees},
                                                       {"frames", DeltaUnit::kFrames}};
  app.add_option("--delta", arguments.delta, "RPE: distance between the two poses of a pair")
      ->type_name("D")
      ->check(support::aboveZero())
      ->capture_default_str();
  app.add_option("--delta-unit", arguments.delta_unit,
                 "RPE: unit of --delta along the estimate: s (time), m (path), rad or deg\n"
                 "(angle turned), frames. Default: s")
      ->type_name("UNIT")
      ->transform(CLI::CheckedTransformer(kUnits).description("{s,m,rad,deg,frames}"));
}

void addPlotOption(CLI::App& app, Arguments& arguments) {
  app.add_option("--plot", arguments.plot,
                 "Draw the aligned trajectories seen along the axis of least extent, and their\n"
                 "error over time, to a PNG file")
      ->type_name("FILE");
}

void addFrameOptions(CLI::App& app, Arguments& arguments) {
  CLI::Option* frames =
      app.add_option("--frames", arguments.frames,
                     "Number of frames given to the system: prints the tracking rate, the share\n"
                     "of them that have a pose")
          ->type_name("N")
          ->check(support::aboveZero());
  app.add_option("--associations", arguments.associations,
                 "List of the frames given to the system (rgb.txt or associations.txt), instead\n"
                 "of --frames")
      ->type_name("FILE")
      ->excludes(frames);
}

/// What CLI11 cannot check by itself.
void finish(RawArguments& raw) {
  Arguments& arguments = raw.arguments;
  if (arguments.delta_unit == DeltaUnit::kFrames &&
      arguments.delta != std::floor(arguments.delta)) {
    throw CLI::ValidationError(
        "--delta", fmt::format("is {} frames; expected a whole number", arguments.delta));
  }
  for (const std::string& text : raw.estimates) {
    arguments.estimates.push_back(parseSystemFile(text, kUnnamedSystem));
  }
  for (const std::string& text : raw.baselines) {
    arguments.baselines.push_back(parseSystemFile(text, "baseline"));
    const std::string& system = arguments.baselines.back().system;
    if (system != arguments.baselines.front().system) {
      throw CLI::ValidationError(
          "--baseline", fmt::format("names the systems {} and {}; expected runs of one system",
                                    arguments.baselines.front().system, system));
    }
    for (const SystemFile& estimate : arguments.estimates) {
      if (estimate.system == system) {
        throw CLI::ValidationError("--baseline",
                                   fmt::format("has the name {}, as an --estimate has", system));
      }
    }
  }
}

}  // namespace

std::variant<Arguments, int> parseCommandLine(int argc, const char* const* argv) {
  RawArguments raw;
  CLI::App app(kDescription, "hmcdyn_evaluate");
  app.footer(kFooter);
  app.require_subcommand(1);
  app.get_formatter()->column_width(28);

  CLI::App* ate = app.add_subcommand(
      "ate", "Absolute trajectory error (m): distance to the ground truth after alignment");
  addCommonOptions(*ate, raw);
  addPlotOption(*ate, raw.arguments);
  CLI::App* rpe = app.add_subcommand(
      "rpe", "Relative pose error: translation (m) and rotation (deg) gone wrong per delta");
  addCommonOptions(*rpe, raw);
  addDeltaOptions(*rpe, raw.arguments);
  CLI::App* summary =
      app.add_subcommand("summary", "ATE, RPE and, where the frames are known, tracking rate (%)");
  addCommonOptions(*summary, raw);
  addDeltaOptions(*summary, raw.arguments);
  addFrameOptions(*summary, raw.arguments);
  addPlotOption(*summary, raw.arguments);

  if (const auto code = support::parseCommandLine(app, argc, argv, [&raw] { finish(raw); })) {
    return *code;
  }
  raw.arguments.command = ate->parsed()   ? Command::kAte
                          : rpe->parsed() ? Command::kRpe
                                          : Command::kSummary;
  return raw.arguments;
}

}  // namespace hmcdyn::evaluate

// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <iostream>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "evaluate/map_score.hpp"
#include "evaluate/point_cloud_file.hpp"
#include "evaluate/pose_alignment.hpp"
#include "support/command_line.hpp"

namespace {

using namespace hmcdyn::evaluate;

struct Arguments {
  std::filesystem::path sequence;
  std::filesystem::path map;
  std::filesystem::path trajectory;
  MapScoreOptions options;
  bool json = false;
};

/// The map in the truth's world, through the trajectory that belongs to it.
std::vector<Eigen::Vector3f> alignedPoints(const Arguments& arguments) {
  std::vector<Eigen::Vector3f> points = readPlyPositions(arguments.map);
  if (!arguments.trajectory.empty()) {
    const Alignment alignment = alignPoses(readTrajectory(arguments.sequence / "groundtruth.txt"),
                                           readTrajectory(arguments.trajectory));
    for (Eigen::Vector3f& point : points) {
      point = (alignment * point.cast<double>()).cast<float>();
    }
  }
  return points;
}

void run(const Arguments& arguments) {
  const MapScore score = scoreMap(alignedPoints(arguments), arguments.sequence, arguments.options);
  if (arguments.json) {
    const nlohmann::json report = {{"sequence", arguments.sequence.string()},
                                   {"map", arguments.map.string()},
                                   {"ghost_share", score.ghostShare()},
                                   {"coverage", score.coverage()},
                                   {"points",
                                    {{"on_surface", score.on_surface},
                                     {"floating", score.floating},
                                     {"buried", score.buried},
                                     {"unseen", score.unseen}}},
                                   {"surface_samples", score.surface},
                                   {"covered_samples", score.covered}};
    std::cout << report.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << '\n';
    return;
  }
  fmt::print(
      "{:.4f} ghosts ({} floating, {} buried, {} on a surface, {} unseen)\n"
      "{:.4f} of the static surfaces covered ({} of {} samples)\n",
      score.ghostShare(), score.floating, score.buried, score.on_surface, score.unseen,
      score.coverage(), score.covered, score.surface);
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  MapScoreOptions& options = arguments.options;
  CLI::App app(
      "Scores a map (PLY) against a rendered sequence (hmcdyn_synthesize): the share of its "
      "points\n"
      "that lie on no static surface (ghosts), and how much of the surfaces it holds.",
      "hmcdyn_map_score");
  app.footer(
      "Example: hmcdyn_map_score walking_xyz out/map.ply --trajectory out/trajectory.txt\n"
      "Exit code: 0 done, 1 a file is missing or malformed, 2 wrong usage.");
  app.add_option("sequence", arguments.sequence, "Folder of hmcdyn_synthesize")->required();
  app.add_option("map", arguments.map, "PLY file")->required();
  app.add_option("--trajectory", arguments.trajectory,
                 "The run's trajectory (TUM format), to align the map with the ground truth;\n"
                 "without it the map is in the ground truth's world already");
  app.add_option("--tolerance", options.tolerance_base, "Distance from a surface (m)")
      ->check(hmcdyn::support::zeroOrMore())
      ->capture_default_str();
  app.add_option("--tolerance-slope", options.tolerance_slope,
                 "Added to it, times the square of the depth (1/m)")
      ->check(hmcdyn::support::zeroOrMore())
      ->capture_default_str();
  app.add_option("--every", options.every, "Every so many frames count")
      ->check(hmcdyn::support::aboveZero())
      ->capture_default_str();
  app.add_option("--radius", options.coverage_radius,
                 "A surface is covered where a map point is so near (m)")
      ->check(hmcdyn::support::aboveZero())
      ->capture_default_str();
  app.add_option("--max-depth", options.max_depth, "Surfaces farther away need no points (m)")
      ->check(hmcdyn::support::aboveZero())
      ->capture_default_str();
  app.add_flag("--json", arguments.json, "Print JSON instead of two lines");
  if (const auto code = hmcdyn::support::parseCommandLine(app, argc, argv)) {
    return *code;
  }
  return hmcdyn::support::exitCodeOf("hmcdyn_map_score", [&] { run(arguments); });
}

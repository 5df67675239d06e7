// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "octomap/occupancy.hpp"
#include "support/command_line.hpp"

namespace {

using hmcdyn::occupancy::GhostCount;
using hmcdyn::occupancy::OccupancyOptions;

struct Arguments {
  OccupancyOptions options;
  std::filesystem::path truth;
  std::filesystem::path output;
};

void declare(CLI::App& app, Arguments& arguments) {
  OccupancyOptions& options = arguments.options;
  app.add_option("--dataset", options.dataset, "Folder in TUM format")->required();
  app.add_option("--camera", options.camera, "tum1, tum2, tum3, bonn, or a calibration file (YAML)")
      ->required();
  app.add_option("--masks", options.masks,
                 "Folder of masks, as hmcdyn_mask or hmcdyn_slam --write-masks writes them")
      ->required();
  app.add_option("--trajectory", options.trajectory,
                 "Poses of the camera (default: DATASET/groundtruth.txt)");
  app.add_option("--truth", arguments.truth,
                 "Folder of true masks, to count ghosts by (default: DATASET/mask)");
  app.add_option("--output", arguments.output, "Write the map with masks (.bt)");
  app.add_option("--resolution", options.resolution, "Side of a voxel (m)")
      ->check(hmcdyn::support::aboveZero())
      ->capture_default_str();
  app.add_option("--max-depth", options.max_depth, "Farther pixels (m) are left out")
      ->check(hmcdyn::support::aboveZero())
      ->capture_default_str();
  app.add_option("--pixel-step", options.pixel_step, "Every so many columns and rows")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
}

void run(Arguments arguments) {
  OccupancyOptions& options = arguments.options;
  if (options.trajectory.empty()) {
    options.trajectory = options.dataset / "groundtruth.txt";
  }
  OccupancyOptions truth = options;
  truth.masks = arguments.truth.empty() ? options.dataset / "mask" : arguments.truth;
  OccupancyOptions all = options;
  all.masks.clear();
  fmt::print("{:<14} {:>9} {:>8}\n", "", "occupied", "ghosts");
  const auto print = [&](const char* name, const octomap::OcTree& map) {
    const GhostCount count = countGhosts(map, truth);
    fmt::print("{:<14} {:>9} {:>8}\n", name, count.occupied, count.ghosts);
  };
  print("without masks", *buildMap(all));
  const std::unique_ptr<octomap::OcTree> map = buildMap(options);
  print("with masks", *map);
  if (!arguments.output.empty() && !map->writeBinary(arguments.output.string())) {
    throw std::runtime_error(arguments.output.string() + ": cannot be written");
  }
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app(
      "Builds an OctoMap of a recording with and without what motion masks leave out, and counts\n"
      "ghosts: occupied voxels that no static surface of the true masks is in or beside.",
      "hmcdyn_octomap");
  app.footer("Exit code: 0 done, 1 a file is missing or malformed, 2 wrong usage.");
  declare(app, arguments);
  if (const auto code = hmcdyn::support::parseCommandLine(app, argc, argv)) {
    return *code;
  }
  return hmcdyn::support::exitCodeOf("hmcdyn_octomap", [&] { run(arguments); });
}
